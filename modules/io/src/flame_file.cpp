#include "mien/io/flame_file.h"

#include <cmath>
#include <functional>
#include <optional>

#include "mien/core/flame_parameters.h"
#include "mien/io/mapped_file.h"
#include "mien/io/npy.h"
#include "mien/io/pickle.h"
#include "mien/io/zip_file.h"

namespace mien {
namespace {

constexpr std::int64_t kMostVertices = 1'000'000;
constexpr std::int64_t kNumJoints = kNumFlameJoints, kNumFeatures = kNumFlamePoseFeatures;

/// Numbers in row-major order.
struct Numbers {
  std::vector<std::int64_t> shape;
  std::vector<double> values;
};
/// A member of the file by name: nothing when it is absent.
using Member = std::function<Result<std::optional<Numbers>>(std::string_view)>;

Error misfit(std::string_view file, const std::string& why) {
  return {Errc::incompatible, std::string(file), why,
          "Expected is generic_model.pkl of a FLAME release, or an .npz with its arrays"};
}

std::string shape_text_of(const std::vector<std::int64_t>& shape) {
  std::string text;
  for (const auto size : shape) text += (text.empty() ? "" : ", ") + std::to_string(size);
  return "[" + text + "]";
}

Result<Numbers> numbers_of(const PickleArray& array) {
  MIEN_TRY(auto values, array.to_doubles());
  return Numbers{array.shape, std::move(values)};
}

// A matrix of scipy in compressed columns, written out.
Result<std::optional<Numbers>> dense(const PickleValue& members, std::string_view name,
                                     std::string_view file) {
  const auto part = [&](const char* key) -> const PickleArray* {
    const auto value = members.find(key);
    return value ? value->array() : nullptr;
  };
  const auto *data = part("data"), *indices = part("indices"), *starts = part("indptr");
  if (data == nullptr || indices == nullptr || starts == nullptr) return std::optional<Numbers>();
  MIEN_TRY(const auto values, data->to_doubles());
  MIEN_TRY(const auto rows, indices->to_doubles());
  MIEN_TRY(const auto bounds, starts->to_doubles());
  const auto damaged = [&] {
    return misfit(file, "has a damaged sparse matrix '" + std::string(name) + "'");
  };
  if (bounds.empty() || rows.size() != values.size()) return damaged();
  const auto num_columns = static_cast<std::int64_t>(bounds.size()) - 1;
  if (num_columns > kMostVertices) return damaged();
  Numbers matrix{{kNumJoints, num_columns},
                 std::vector<double>(static_cast<std::size_t>(kNumJoints * num_columns))};
  for (std::int64_t c = 0; c < num_columns; ++c) {
    const double first = bounds[static_cast<std::size_t>(c)], end = bounds[static_cast<std::size_t>(c) + 1];
    if (!(first >= 0 && first <= end && end <= static_cast<double>(values.size()))) return damaged();
    for (auto k = static_cast<std::size_t>(first); k < static_cast<std::size_t>(end); ++k) {
      if (!(rows[k] >= 0 && rows[k] < kNumJoints)) return damaged();
      matrix.values[static_cast<std::size_t>(static_cast<std::int64_t>(rows[k]) * num_columns + c)] +=
          values[k];
    }
  }
  return std::optional(std::move(matrix));
}

// An array, or an object that holds one: chumpy's as `x`, scipy's matrix in parts.
Result<std::optional<Numbers>> pickled(const PickleValue& root, std::string_view name,
                                       std::string_view file) {
  const auto value = root.find(name);
  if (!value) return std::optional<Numbers>();
  const PickleArray* array = value->array();
  if (array == nullptr) {
    const auto state = value->state();
    if (!state) return std::optional<Numbers>();
    const auto inner = state->find("x");
    if (!inner) return dense(*state, name, file);
    array = inner->array();
    if (array == nullptr) return std::optional<Numbers>();
  }
  MIEN_TRY(auto numbers, numbers_of(*array));
  return std::optional(std::move(numbers));
}

Result<std::optional<Numbers>> zipped(const ZipFile& zip, std::string_view name) {
  const ZipEntry* entry = zip.find(std::string(name) + ".npy");
  if (entry == nullptr) return std::optional<Numbers>();
  Bytes unpacked;
  MIEN_TRY(const auto bytes, zip.read(*entry, unpacked));
  const auto array = npy_elements(bytes);
  if (!array) return within(array.error(), "member '" + std::string(name) + "'");
  MIEN_TRY(auto numbers, numbers_of(*array));
  return std::optional(std::move(numbers));
}

class Reader {
 public:
  Reader(std::string_view file, Member member) : file_(file), member_(std::move(member)) {}

  Result<FlameModel> read() {
    FlameModel m;
    MIEN_TRY(const Numbers neutral, take("v_template", {-1, 3}));
    m.num_vertices = neutral.shape[0];
    if (m.num_vertices < 1 || m.num_vertices > kMostVertices)
      return misfit(file_, "has " + std::to_string(m.num_vertices) + " vertices");
    m.neutral.assign(neutral.values.begin(), neutral.values.end());
    MIEN_TRY(const Numbers shapes, take("shapedirs", {m.num_vertices, 3, -1}));
    m.num_shapes = shapes.shape[2];
    if (m.num_shapes <= static_cast<std::int64_t>(kNumFlameShape))
      return misfit(file_, "has " + std::to_string(m.num_shapes) +
                               " shape directions: expected 300 of shape and some of expression");
    m.shapes = by_direction(shapes);
    MIEN_TRY(const Numbers pose, take("posedirs", {m.num_vertices, 3, kNumFeatures}));
    m.pose_shapes = by_direction(pose);
    MIEN_TRY(const Numbers joints, take("J_regressor", {kNumJoints, m.num_vertices}));
    m.joint_regressor.assign(joints.values.begin(), joints.values.end());
    MIEN_TRY(const Numbers weights, take("weights", {m.num_vertices, kNumJoints}));
    m.weights.assign(weights.values.begin(), weights.values.end());
    MIEN_TRY([[maybe_unused]] const auto parents, read_parents(m));
    MIEN_TRY([[maybe_unused]] const auto faces, read_triangles(m));
    return m;
  }

 private:
  // A member of this shape, where -1 stands for any size.
  Result<Numbers> take(std::string_view name, const std::vector<std::int64_t>& shape) {
    auto found = member_(name);
    if (!found) return within(found.error(), std::string(file_));
    if (!*found) return misfit(file_, "has no array '" + std::string(name) + "'");
    Numbers numbers = std::move(**found);
    bool fits = numbers.shape.size() == shape.size();
    for (std::size_t i = 0; fits && i < shape.size(); ++i)
      fits = shape[i] == -1 || shape[i] == numbers.shape[i];
    if (!fits)
      return misfit(file_, "has '" + std::string(name) + "' of shape " + shape_text_of(numbers.shape) +
                               ", expected " + shape_text_of(shape) + " (-1: any)");
    for (const double v : numbers.values)
      if (!std::isfinite(static_cast<float>(v)))
        return misfit(file_, "has numbers in '" + std::string(name) + "' that are not finite");
    return numbers;
  }

  // [V, 3, D] to [D, V, 3]: a direction is used as a whole.
  static std::vector<float> by_direction(const Numbers& numbers) {
    const auto depth = static_cast<std::size_t>(numbers.shape[2]);
    const std::size_t count = depth == 0 ? 0 : numbers.values.size() / depth;
    std::vector<float> out(numbers.values.size());
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t d = 0; d < depth; ++d)
        out[d * count + i] = static_cast<float>(numbers.values[i * depth + d]);
    return out;
  }

  // Row 0 of the table holds the parents; that of the first joint means none, whatever it is (2^32 - 1).
  Status read_parents(FlameModel& m) {
    MIEN_TRY(const Numbers table, take("kintree_table", {2, kNumJoints}));
    m.parents[0] = -1;
    for (std::size_t j = 1; j < kNumFlameJoints; ++j) {
      const double parent = table.values[j];
      if (!(parent >= 0 && parent < static_cast<double>(j)))
        return misfit(file_, "has a joint whose parent does not stand before it ('kintree_table')");
      m.parents[j] = static_cast<int>(parent);
    }
    return Done{};
  }

  Status read_triangles(FlameModel& m) {
    MIEN_TRY(const Numbers faces, take("f", {-1, 3}));
    for (std::size_t i = 0; i + 2 < faces.values.size(); i += 3) {
      std::array<std::uint32_t, 3> triangle{};
      for (std::size_t k = 0; k < 3; ++k) {
        const double index = faces.values[i + k];
        if (!(index >= 0 && index < static_cast<double>(m.num_vertices)))
          return misfit(file_, "has a triangle of a vertex that does not exist ('f')");
        triangle[k] = static_cast<std::uint32_t>(index);
      }
      m.triangles.push_back(triangle);
    }
    return Done{};
  }

  std::string_view file_;
  Member member_;
};

}  // namespace

Result<FlameModel> parse_flame_model(std::span<const std::byte> bytes, std::string_view name) {
  if (ZipFile::looks_like(bytes)) {
    MIEN_TRY(const ZipFile zip, ZipFile::parse(bytes, name));
    return Reader(name, [&](std::string_view member) { return zipped(zip, member); }).read();
  }
  MIEN_TRY(const Pickle pickle, Pickle::parse(bytes, name, {.keep_foreign = true}));
  const PickleValue root = pickle.root();
  if (root.kind() != PickleKind::dict) return misfit(name, "is a pickle of something else");
  return Reader(name, [&](std::string_view member) { return pickled(root, member, name); }).read();
}

Result<FlameModel> read_flame_model(const std::filesystem::path& path) {
  MIEN_TRY(const MappedFile file, MappedFile::open(path));
  return parse_flame_model(file.bytes(), "'" + path.string() + "'");
}

}  // namespace mien
