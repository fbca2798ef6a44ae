#include "training_options.h"

#include <functional>

namespace mien {
namespace {

constexpr int kMostDepth = 16, kMostValues = 20000;
// Members of OmegaConf's objects: what a node holds, its number, and the way back up.
constexpr std::string_view kContent = "_content", kNumber = "_val", kParent = "_parent";

// What an OmegaConf container or node stands for; other values stand for themselves.
PickleValue unwrapped(PickleValue value) {
  for (int depth = 0; depth < kMostDepth; ++depth) {
    const auto state = value.kind() == PickleKind::object ? value.state() : std::nullopt;
    if (!state) return value;
    auto inner = state->find(kContent);
    if (!inner) inner = state->find(kNumber);
    if (!inner) return *state;
    value = *inner;
  }
  return value;
}

// Calls use(value) for what stands under the key, at any depth, until it says that it is content.
class Search {
 public:
  Search(std::string_view key, std::function<bool(const PickleValue&)> use)
      : key_(key), use_(std::move(use)) {}

  bool visit(const PickleValue& given, int depth) {
    if (depth > kMostDepth || ++num_visited_ > kMostValues) return false;
    const PickleValue value = unwrapped(given);
    const bool is_dict = value.kind() == PickleKind::dict;
    if (is_dict)
      if (const auto found = value.find(key_); found && use_(unwrapped(*found))) return true;
    if (!is_dict && value.kind() != PickleKind::list && value.kind() != PickleKind::tuple) return false;
    for (std::size_t i = 0; i < value.size(); ++i) {
      if (is_dict && value.key(i).text() == kParent) continue;
      if (visit(value[i], depth + 1)) return true;
    }
    return false;
  }

 private:
  std::string_view key_;
  std::function<bool(const PickleValue&)> use_;
  int num_visited_ = 0;
};

}  // namespace

std::optional<std::int64_t> find_option(const PickleValue& root, std::string_view key) {
  std::optional<std::int64_t> number;
  Search search(key, [&](const PickleValue& value) { return (number = value.integer()).has_value(); });
  search.visit(root, 0);
  return number;
}

std::optional<std::vector<std::int64_t>> find_option_list(const PickleValue& root, std::string_view key) {
  std::optional<std::vector<std::int64_t>> numbers;
  Search search(key, [&](const PickleValue& value) {
    if (value.kind() != PickleKind::list && value.kind() != PickleKind::tuple) return false;
    std::vector<std::int64_t> all;
    for (std::size_t i = 0; i < value.size(); ++i) {
      const auto number = unwrapped(value[i]).integer();
      if (!number) return false;
      all.push_back(*number);
    }
    numbers = std::move(all);
    return true;
  });
  search.visit(root, 0);
  return numbers;
}

}  // namespace mien
