#include "outputs.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <set>

#include "mien/base/file.h"
#include "mien/console/console_exit.h"
#include "nearest_name.h"

namespace mien {
namespace {

namespace fs = std::filesystem;

struct KnownExtension {
  std::string_view extension;
  OutputKind kind;
};
constexpr std::array<KnownExtension, 7> kExtensions = {{{".glb", OutputKind::motion},
                                                        {".csv", OutputKind::motion},
                                                        {".json", OutputKind::motion},
                                                        {".npy", OutputKind::motion},
                                                        {".mp4", OutputKind::video},
                                                        {".webm", OutputKind::video},
                                                        {".png", OutputKind::sheet}}};

std::string lower_extension(const fs::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension;
}

// "frames/" -> "frames", so that stems and parents are those of the folder.
fs::path without_slash(const std::string& name) {
  std::string text = name;
  while (text.size() > 1 && text.back() == '/') text.pop_back();
  return text;
}

Result<Output> plan_output(const std::string& name, std::span<const OutputKind> allowed) {
  const auto is_allowed = [&](OutputKind kind) {
    return std::find(allowed.begin(), allowed.end(), kind) != allowed.end();
  };
  std::error_code ec;
  if (const fs::path folder = without_slash(name);
      name.ends_with('/') && is_allowed(OutputKind::meshes) &&
      (lower_extension(folder) == ".obj" || lower_extension(folder) == ".vl"))
    return Output{.path = folder, .kind = OutputKind::meshes};
  if (name.ends_with('/') && is_allowed(OutputKind::frames))
    return Output{.path = without_slash(name), .kind = OutputKind::frames};
  const std::string extension = lower_extension(name);
  std::vector<std::string> known;
  std::string list;
  for (const auto& e : kExtensions) {
    if (!is_allowed(e.kind)) continue;
    if (extension == e.extension) return Output{.path = name, .kind = e.kind};
    known.emplace_back(e.extension);
    list += (list.empty() ? "" : ", ") + std::string(e.extension);
  }
  if (is_allowed(OutputKind::frames)) list += ", or a folder for numbered pictures: 'frames/'";
  if (is_allowed(OutputKind::meshes)) list += ", or for numbered meshes: 'name.obj/' or 'name.vl/'";
  const std::string near = nearest_name(extension, known);
  return Error{Errc::usage, "output '" + name + "'",
               extension.empty() ? "has no extension to choose a format by"
                                 : "nothing writes the extension '" + extension + "'",
               (near.empty() ? "" : "Did you mean " + near + "? ") + "Known: " + list};
}

Output output_of_take(const Output& output, int take, int num_takes) {
  if (num_takes == 1) return output;
  Output own = output;
  const std::string extension = output.is_folder() ? "" : output.path.extension().string();
  const std::string name = output.path.filename().string();
  own.path.replace_filename(name.substr(0, name.size() - extension.size()) + "-" + std::to_string(take + 1) +
                            extension);
  return own;
}

}  // namespace

bool Output::is_glb() const { return lower_extension(path) == ".glb"; }

Result<std::vector<Output>> plan_outputs(std::span<const std::string> names, std::span<const fs::path> inputs,
                                         std::span<const OutputKind> allowed, int num_takes) {
  std::vector<Output> outputs;
  std::set<fs::path> seen;
  for (int take = 0; take < num_takes; ++take) {
    for (const auto& name : names) {
      MIEN_TRY(const auto output, plan_output(name, allowed));
      outputs.push_back(output_of_take(output, take, num_takes));
      const fs::path& path = outputs.back().path;
      const std::string what = "output '" + path.string() + "'";
      std::error_code ec;
      for (const auto& input : inputs)
        if (fs::equivalent(path, input, ec))
          return Error{Errc::usage, what, "is an input of this command", "Choose another name"};
      if (!seen.insert(fs::weakly_canonical(fs::absolute(path, ec), ec)).second)
        return Error{Errc::usage, what, "is given twice", ""};
    }
  }
  return outputs;
}

std::string output_list(const std::vector<Output>& outputs) {
  std::string list;
  for (const auto& output : outputs)
    list +=
        (list.empty() ? "" : ", ") + output.path.string() + (output.kind == OutputKind::frames ? "/" : "");
  return list;
}

std::string json_list(const std::vector<Output>& outputs) {
  std::string list;
  for (const auto& output : outputs) list += (list.empty() ? "" : ",") + json_string(output.path.string());
  return "[" + list + "]";
}

Status check_writable(std::span<const Output> outputs) {
  for (const auto& output : outputs) {
    std::error_code ec;
    if (output.is_folder() && fs::is_directory(output.path, ec)) {
      MIEN_TRY([[maybe_unused]] const auto probe, AtomicFile::create(output.path / "frame.png"));
      continue;
    }
    if (output.is_folder() && fs::exists(output.path, ec))
      return Error{Errc::failed, "'" + output.path.string() + "'", "is a file, expected a folder", ""};
    MIEN_TRY([[maybe_unused]] const auto probe, AtomicFile::create(output.path));
  }
  return Done{};
}

}  // namespace mien
