#include "fixture.h"

#include <algorithm>
#include <cstdlib>
#include <stdexcept>

#include "test_paths.h"

namespace mien::parity {
namespace {

template <class T>
T taken(Result<T> result) {
  if (!result) throw std::runtime_error(result.error().message());
  return std::move(result).value();
}

}  // namespace

std::filesystem::path fixture_root() {
  if (const char* root = std::getenv("MIEN_FIXTURES"); root != nullptr && *root != '\0') return root;
  const auto shared = shared_path("fixtures");
  std::error_code absent;
  return std::filesystem::is_directory(shared, absent) ? shared : project_path("tests/data/fixtures");
}

std::vector<std::string> cases(std::string_view folder, std::string_view prefix, std::string_view suffix) {
  std::vector<std::string> names;
  std::error_code problem;
  for (const auto& entry : std::filesystem::directory_iterator(fixture_root() / folder, problem)) {
    const std::string file = entry.path().filename().string();
    if (file.size() <= prefix.size() + suffix.size() || !file.starts_with(prefix) || !file.ends_with(suffix))
      continue;
    std::string name = file.substr(prefix.size(), file.size() - prefix.size() - suffix.size());
    if (name.find('.') == std::string::npos) names.push_back(std::move(name));
  }
  std::sort(names.begin(), names.end());
  return names;
}

Fixture::Fixture(std::string_view folder, const std::string& file)
    : file_(taken(SafetensorsFile::open(fixture_root() / folder / file))) {}

const std::string& Fixture::metadata(const std::string& key) const { return file_.metadata().at(key); }

Tensor Fixture::tensor(std::string_view name) const {
  const std::vector<float> values = taken(file_.read_float(name));
  Shape shape = file_.find(name)->shape;
  while (shape.size() > 1 && shape.front() == 1) shape.erase(shape.begin());
  return Tensor(std::move(shape), values);
}

Tensor Fixture::slice(std::string_view name, std::int64_t i) const {
  const auto all = taken(file_.as<float>(name));
  const Shape& shape = file_.find(name)->shape;
  if (shape.size() != 3 || i < 0 || i >= shape[0])
    throw std::runtime_error(std::string(name) + " has no slice " + std::to_string(i));
  const auto count = static_cast<std::size_t>(shape[1] * shape[2]);
  return Tensor({shape[1], shape[2]}, all.subspan(static_cast<std::size_t>(i) * count, count));
}

std::vector<double> Fixture::doubles(std::string_view name) const {
  const auto all = taken(file_.as<double>(name));
  return {all.begin(), all.end()};
}

std::vector<std::int64_t> Fixture::integers(std::string_view name) const {
  const auto all = taken(file_.as<std::int64_t>(name));
  return {all.begin(), all.end()};
}

}  // namespace mien::parity
