#include "table_reader.h"

#define TOML_EXCEPTIONS 0
#include <toml++/toml.h>

#include <limits>
#include <map>
#include <set>

#include "mien/base/file.h"

namespace mien::train {

namespace {
constexpr double kUnlimited = std::numeric_limits<double>::infinity();
}  // namespace

Range at_least(std::int64_t least) {
  return {static_cast<double>(least), kUnlimited, true, false, "must be at least " + std::to_string(least)};
}
Range above_zero() { return {0, kUnlimited, false, false, "must be above 0"}; }
Range not_negative() { return {0, kUnlimited, true, false, "must not be negative"}; }
Range share() { return {0, 1, true, true, "must lie in [0, 1]"}; }
Range share_below_one() { return {0, 1, true, false, "must lie in [0, 1)"}; }

struct TomlFile::State {
  std::filesystem::path path;
  std::string text, problems;
  toml::table root;
  std::map<std::string, std::set<std::string>> known;  // fields by table

  // The field; nothing when it is absent.
  toml::node* find(const char* table, const char* key) {
    known[table].insert(key);
    toml::table* found = root[table].as_table();
    return found == nullptr ? nullptr : found->get(key);
  }
  void complain(const toml::node& node, const std::string& problem) {
    problems += "line " + std::to_string(node.source().begin.line) + ": " + problem + "; ";
  }
};

TomlFile::TomlFile(std::unique_ptr<State> state) : state_(std::move(state)) {}
TomlFile::TomlFile(TomlFile&&) noexcept = default;
TomlFile::~TomlFile() = default;

Result<TomlFile> TomlFile::open(const std::filesystem::path& path) {
  MIEN_TRY(const auto bytes, read_file(path));
  auto state = std::make_unique<State>();
  state->path = path;
  state->text = as_text(bytes);
  toml::parse_result parsed = toml::parse(state->text);
  if (!parsed)
    return Error{Errc::usage,
                 "'" + path.string() + "' line " + std::to_string(parsed.error().source().begin.line),
                 std::string(parsed.error().description()), ""};
  state->root = std::move(parsed).table();
  return TomlFile(std::move(state));
}

template <class T, class Stored>
void TomlFile::read_as(const char* table, const char* key, Stored& value) {
  toml::node* node = state_->find(table, key);
  if (node == nullptr) return;
  if (const auto v = node->value_exact<T>())
    value = static_cast<Stored>(*v);
  else
    state_->complain(*node, "'" + std::string(key) + "' has the wrong type");
}

void TomlFile::read(const char* table, const char* key, std::string& value) {
  read_as<std::string>(table, key, value);
}
void TomlFile::read(const char* table, const char* key, std::filesystem::path& value) {
  read_as<std::string>(table, key, value);
}
void TomlFile::read(const char* table, const char* key, std::int64_t& value) {
  read_as<std::int64_t>(table, key, value);
}
void TomlFile::read(const char* table, const char* key, std::uint64_t& value) {
  read_as<std::int64_t>(table, key, value);
}
void TomlFile::read(const char* table, const char* key, int& value) {
  read_as<std::int64_t>(table, key, value);
}
void TomlFile::read(const char* table, const char* key, bool& value) { read_as<bool>(table, key, value); }

// A whole number is a good double, too.
void TomlFile::read(const char* table, const char* key, double& value) {
  toml::node* node = state_->find(table, key);
  if (node == nullptr) return;
  if (const auto v = node->value<double>())
    value = *v;
  else
    state_->complain(*node, "'" + std::string(key) + "' has the wrong type");
}

void TomlFile::read(const char* table, const char* key, std::vector<std::string>& value) {
  toml::node* node = state_->find(table, key);
  if (node == nullptr) return;
  const toml::array* array = node->as_array();
  std::vector<std::string> texts;
  if (array != nullptr)
    for (const auto& element : *array)
      if (const auto v = element.value_exact<std::string>()) texts.push_back(*v);
  if (array == nullptr || texts.size() != array->size())
    return state_->complain(*node, "'" + std::string(key) + "' is not a list of texts");
  value = std::move(texts);
}

bool TomlFile::has_table(const char* table) const { return state_->root[table].is_table(); }
bool TomlFile::has(const char* table, const char* key) { return state_->find(table, key) != nullptr; }
std::string TomlFile::field_name(const char* table, const char* key) {
  return "[" + std::string(table) + "] " + key;
}

void TomlFile::complain(const std::string& problem) { state_->problems += problem + "; "; }
const std::string& TomlFile::text() const { return state_->text; }

Status TomlFile::finish(const std::string& see) const {
  std::string problems = state_->problems;
  for (const auto& [name, node] : state_->root) {
    const std::string line = "line " + std::to_string(node.source().begin.line) + ": ";
    const auto known = state_->known.find(std::string(name.str()));
    if (known == state_->known.end() || !node.is_table()) {
      problems += line + "unknown table [" + std::string(name.str()) + "]; ";
      continue;
    }
    for (const auto& [key, field] : *node.as_table())
      if (!known->second.contains(std::string(key.str())))
        problems += "line " + std::to_string(field.source().begin.line) + ": unknown field '" +
                    std::string(key.str()) + "' in [" + std::string(name.str()) + "]; ";
  }
  if (problems.empty()) return Done{};
  return Error{Errc::usage, "'" + state_->path.string() + "'", problems, see};
}

}  // namespace mien::train
