#include "weights_source.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "mien/base/file.h"
#include "mien/io/torch_checkpoint.h"
#include "mien/io/zip_file.h"

namespace mien {
namespace {

namespace fs = std::filesystem;
constexpr std::size_t kMostParts = 1000;

class SafetensorsWeights final : public WeightsSource {
 public:
  explicit SafetensorsWeights(SafetensorsFile file) : file_(std::move(file)) {}
  const std::vector<StoredTensor>& tensors() const override { return file_.tensors(); }
  Result<std::vector<float>> read(std::string_view name) const override { return file_.read_float(name); }

 private:
  SafetensorsFile file_;
};

class TorchWeights final : public WeightsSource {
 public:
  explicit TorchWeights(TorchCheckpoint file) : file_(std::move(file)) {}
  const std::vector<StoredTensor>& tensors() const override { return file_.tensors(); }
  Result<std::vector<float>> read(std::string_view name) const override { return file_.read_float(name); }
  std::optional<PickleValue> training_options() const override {
    const PickleValue root = file_.root();
    return root.kind() == PickleKind::dict ? root.find("hyper_parameters") : std::nullopt;
  }

 private:
  TorchCheckpoint file_;
};

/// One model in several files.
class ShardedWeights final : public WeightsSource {
 public:
  Status add(SafetensorsFile part, const std::string& part_name) {
    for (const auto& tensor : part.tensors()) {
      if (!part_of_.emplace(tensor.name, parts_.size()).second)
        return Error{Errc::input, part_name, "holds the tensor '" + tensor.name + "' of another part", ""};
      tensors_.push_back(tensor);
    }
    parts_.push_back(std::move(part));
    return Done{};
  }
  const std::vector<StoredTensor>& tensors() const override { return tensors_; }
  Result<std::vector<float>> read(std::string_view name) const override {
    return parts_[part_of_.find(name)->second].read_float(name);
  }

 private:
  std::vector<SafetensorsFile> parts_;
  std::vector<StoredTensor> tensors_;
  std::map<std::string, std::size_t, std::less<>> part_of_;
};

Result<std::unique_ptr<WeightsSource>> open_sharded(const fs::path& index) {
  const std::string name = "'" + index.string() + "'";
  MIEN_TRY(const auto text, read_file(index));
  const auto json = nlohmann::json::parse(as_text(text), nullptr, /*allow_exceptions=*/false);
  if (!json.is_object() || !json.contains("weight_map") || !json["weight_map"].is_object())
    return Error{Errc::input, name, "is no index of weights: it has no weight_map", ""};
  std::set<std::string> files;
  for (const auto& [tensor, file] : json["weight_map"].items()) {
    if (!file.is_string() || fs::path(file.get<std::string>()).filename() != file.get<std::string>())
      return Error{Errc::input, name, "names for '" + tensor + "' no file of its own folder", ""};
    files.insert(file.get<std::string>());
  }
  if (files.empty() || files.size() > kMostParts)
    return Error{Errc::input, name, "names " + std::to_string(files.size()) + " files, expected 1 to 1000",
                 ""};
  auto weights = std::make_unique<ShardedWeights>();
  for (const auto& file : files) {
    MIEN_TRY(auto part, SafetensorsFile::open(index.parent_path() / file));
    MIEN_TRY([[maybe_unused]] const auto added, weights->add(std::move(part), name));
  }
  for (const auto& [tensor, file] : json["weight_map"].items())
    if (std::ranges::find(weights->tensors(), tensor, &StoredTensor::name) == weights->tensors().end())
      return Error{Errc::input, name, "promises the tensor '" + tensor + "', which no part holds", ""};
  return std::unique_ptr<WeightsSource>(std::move(weights));
}

Result<std::unique_ptr<WeightsSource>> open_file(const fs::path& path) {
  if (path.filename().string().ends_with(".index.json")) return open_sharded(path);
  if (path.extension() == ".safetensors") {
    MIEN_TRY(auto file, SafetensorsFile::open(path));
    return std::unique_ptr<WeightsSource>(std::make_unique<SafetensorsWeights>(std::move(file)));
  }
  auto checkpoint = TorchCheckpoint::open(path);
  if (checkpoint)
    return std::unique_ptr<WeightsSource>(std::make_unique<TorchWeights>(std::move(*checkpoint)));
  if (auto file = SafetensorsFile::open(path); file)  // under another name
    return std::unique_ptr<WeightsSource>(std::make_unique<SafetensorsWeights>(std::move(*file)));
  return checkpoint.error();
}

}  // namespace

std::map<std::string, StoredTensor> WeightsSource::by_name() const {
  std::map<std::string, StoredTensor> all;
  for (const auto& tensor : tensors()) all.emplace(tensor.name, tensor);
  return all;
}

Result<std::unique_ptr<WeightsSource>> open_weights(const fs::path& path) {
  std::error_code ec;
  if (!fs::is_directory(path, ec)) return open_file(path);
  for (const char* name : {"model.safetensors", "model.safetensors.index.json", "pytorch_model.bin"})
    if (fs::exists(path / name, ec)) return open_file(path / name);
  return Error{Errc::input, "'" + path.string() + "'",
               "is a folder without model.safetensors, model.safetensors.index.json or pytorch_model.bin",
               "Name the folder of a Hugging Face model, or the file itself"};
}

}  // namespace mien
