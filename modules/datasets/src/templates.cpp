#include "mien/datasets/templates.h"

#include <cctype>
#include <cmath>

#include "mien/io/file_extension.h"
#include "mien/io/mesh_file.h"
#include "mien/io/pickle.h"
#include "mien/io/safetensors.h"

namespace mien {
namespace {

namespace fs = std::filesystem;
constexpr std::string_view kPrefix = "template.";

Result<Templates> from_pickle(const fs::path& path) {
  MIEN_TRY(const Pickle pickle, Pickle::open(path));
  const PickleValue root = pickle.root();
  const std::string name = "'" + path.string() + "'";
  if (root.kind() != PickleKind::dict)
    return Error{Errc::incompatible, name, "is not a dictionary of templates",
                 "Use the data set's templates.pkl"};
  Templates templates;
  for (std::size_t i = 0; i < root.size(); ++i) {
    const auto subject = root.key(i).text();
    const PickleArray* array = root[i].array();
    if (!subject || array == nullptr)
      return Error{Errc::incompatible, name,
                   "entry " + std::to_string(i) + " is not an array under a subject's name", ""};
    const bool is_mesh = (array->shape.size() == 2 && array->shape[1] == 3) ||
                         (array->shape.size() == 1 && array->shape[0] % 3 == 0);
    if (!is_mesh)
      return Error{Errc::incompatible, name, "the template of '" + std::string(*subject) + "' is not [V, 3]",
                   ""};
    MIEN_TRY(templates[std::string(*subject)], array->to_floats());
  }
  return templates;
}

Result<Templates> from_safetensors(const fs::path& path) {
  MIEN_TRY(const auto file, SafetensorsFile::open(path));
  Templates templates;
  for (const auto& tensor : file.tensors()) {
    if (!tensor.name.starts_with(kPrefix)) continue;
    if (tensor.count() % 3 != 0)
      return Error{Errc::incompatible, "'" + path.string() + "'", "'" + tensor.name + "' is not [V, 3]", ""};
    MIEN_TRY(templates[tensor.name.substr(kPrefix.size())], file.read_float(tensor.name));
  }
  return templates;
}

Status add_mesh(const fs::path& path, Templates& templates) {
  MIEN_TRY(const Mesh mesh, load_mesh(path));
  auto& values = templates[path.stem().string()];
  for (const Vec3& p : mesh.positions) values.insert(values.end(), {p.x, p.y, p.z});
  return Done{};
}

Result<Templates> from_any(const fs::path& path) {
  std::error_code ec;
  Templates templates;
  if (fs::is_directory(path, ec)) {
    for (const auto& entry : fs::directory_iterator(path, ec)) {
      const std::string extension = lower_extension(entry.path());
      if (extension != ".obj" && extension != ".ply") continue;
      MIEN_TRY([[maybe_unused]] const auto added, add_mesh(entry.path(), templates));
    }
    return templates;
  }
  const std::string extension = lower_extension(path);
  if (extension == ".pkl" || extension == ".pickle") return from_pickle(path);
  if (extension == ".safetensors") return from_safetensors(path);
  MIEN_TRY([[maybe_unused]] const auto added, add_mesh(path, templates));
  return templates;
}

}  // namespace

Result<Templates> load_templates(const fs::path& path) {
  auto templates = from_any(path);
  if (!templates) return within(templates.error(), "templates");
  const std::string name = "templates '" + path.string() + "'";
  if (templates->empty()) return Error{Errc::incompatible, name, "hold no template", ""};
  const std::size_t size = templates->begin()->second.size();
  for (const auto& [subject, values] : *templates) {
    if (values.size() != size || size == 0)
      return Error{Errc::incompatible, name,
                   "'" + subject + "' has " + std::to_string(values.size() / 3) + " vertices, '" +
                       templates->begin()->first + "' has " + std::to_string(size / 3),
                   ""};
    for (const float x : values)
      if (!std::isfinite(x))
        return Error{Errc::input, name, "'" + subject + "' holds a number that is not finite", ""};
  }
  return templates;
}

Status write_templates(const fs::path& path, const Templates& templates) {
  std::vector<StoredTensor> tensors;
  for (const auto& [subject, values] : templates)
    tensors.push_back(
        {std::string(kPrefix) + subject, Dtype::f32, {static_cast<std::int64_t>(values.size() / 3), 3}});
  MIEN_TRY(auto writer, SafetensorsWriter::create(path, tensors));
  for (const auto& [subject, values] : templates) {
    MIEN_TRY([[maybe_unused]] const auto written, writer.write(std::string(kPrefix) + subject, values));
  }
  return writer.finish();
}

}  // namespace mien
