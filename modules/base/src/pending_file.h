#pragma once
#include <filesystem>
#include <optional>

namespace mien {

/// A new file that does not have its name yet, open for writing. Destroyed before appear(), it is gone.
class PendingFile {
 public:
  /// Without any name, in the folder of `final_path`: it goes with the process, however that ends. Nothing
  /// where that cannot be had, on some file systems or without /proc.
  static std::optional<PendingFile> unnamed(const std::filesystem::path& final_path);
  /// With a hidden name in the same folder, which a killed process leaves behind. Nothing on failure; errno
  /// says why.
  static std::optional<PendingFile> hidden(const std::filesystem::path& final_path);
  /// The hidden name: of this process, and with the extension last, since libraries choose a format by it.
  static std::filesystem::path hidden_name(const std::filesystem::path& final_path);

  PendingFile(PendingFile&& other) noexcept;
  PendingFile& operator=(PendingFile&& other) noexcept;
  ~PendingFile();

  [[nodiscard]] int descriptor() const { return descriptor_; }
  /// A name under which this process can open it.
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// Gives the file its name, in place of what had it. @return 0 or the error number
  int appear(const std::filesystem::path& final_path);

 private:
  PendingFile(int descriptor, std::filesystem::path path, bool has_name)
      : descriptor_(descriptor), path_(std::move(path)), has_name_(has_name) {}

  int descriptor_ = -1;
  std::filesystem::path path_;
  bool has_name_ = false;
};

}  // namespace mien
