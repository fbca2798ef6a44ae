#include "pickle_machine.h"

#include <algorithm>
#include <bit>

namespace mien {
namespace {

constexpr std::size_t kMaxMemory = 4'000'000;

}  // namespace

bool PickleMachine::take(std::size_t count, std::string_view& out) {
  if (count > bytes_.size() - position_) return truncated();
  out = as_text(bytes_.subspan(position_, count));
  position_ += count;
  return true;
}

bool PickleMachine::line(std::string_view& out) {
  const auto rest = as_text(bytes_.subspan(position_));
  const auto end = rest.find('\n');
  if (end == rest.npos) return truncated();
  out = rest.substr(0, end);
  position_ += end + 1;
  return true;
}

bool PickleMachine::push(PickleRef ref) {
  if (ref == kNoRef) return false;  // the error is stored
  stack_.push_back(ref);
  return true;
}

bool PickleMachine::top(PickleRef& out) {
  if (stack_.size() <= (marks_.empty() ? 0 : marks_.back())) return fail("takes a value that is not there");
  out = stack_.back();
  return true;
}

bool PickleMachine::pop(PickleRef& out) {
  if (!top(out)) return false;
  stack_.pop_back();
  return true;
}

bool PickleMachine::pop_to_mark(std::vector<PickleRef>& out) {
  if (marks_.empty()) return fail("ends a group that never began");
  const auto begin = stack_.begin() + static_cast<std::ptrdiff_t>(marks_.back());
  out.assign(begin, stack_.end());
  stack_.erase(begin, stack_.end());
  marks_.pop_back();
  return calls_.spend(out.size());
}

bool PickleMachine::push_long(std::string_view bytes) {
  if (bytes.size() > 8) return push({.kind = PickleKind::big_integer, .text = bytes});
  std::uint64_t value = !bytes.empty() && static_cast<signed char>(bytes.back()) < 0 ? ~std::uint64_t{0} : 0;
  for (std::size_t i = bytes.size(); i-- > 0;) value = (value << 8) | static_cast<unsigned char>(bytes[i]);
  return push({.kind = PickleKind::integer, .integer = static_cast<std::int64_t>(value)});
}

bool PickleMachine::push_tuple(std::size_t count) {
  PickleNode tuple{.kind = PickleKind::tuple};
  tuple.items.resize(count);
  for (std::size_t i = count; i-- > 0;)
    if (!pop(tuple.items[i])) return false;
  return calls_.spend(count) && push(std::move(tuple));
}

bool PickleMachine::remember(std::uint64_t index) {
  PickleRef value = kNoRef;
  if (!top(value)) return false;
  if (index >= kMaxMemory) return fail("remembers more than " + std::to_string(kMaxMemory) + " values");
  if (index >= memory_.size()) memory_.resize(static_cast<std::size_t>(index) + 1, kNoRef);
  memory_[static_cast<std::size_t>(index)] = value;
  ++remembered_;
  return true;
}

bool PickleMachine::recall(std::uint64_t index) {
  if (index >= memory_.size() || memory_[static_cast<std::size_t>(index)] == kNoRef)
    return fail("recalls a value that it never stored");
  return push(memory_[static_cast<std::size_t>(index)]);
}

// Adds items to the container on top. An object that was kept aside may be a list or a dictionary of its own
// kind: its items are of no interest.
bool PickleMachine::append(PickleKind kind, std::vector<PickleRef> items) {
  PickleRef container = kNoRef;
  if (!top(container)) return false;
  auto& node = heap_.nodes[container];
  if (node.kind == PickleKind::object) return true;
  if (node.kind != kind) return fail("adds items to a value that holds none");
  if (kind == PickleKind::dict && items.size() % 2 != 0) return fail("has a dictionary key without a value");
  node.items.insert(node.items.end(), items.begin(), items.end());
  return true;
}

bool PickleMachine::call_top(bool has_keywords) {
  PickleRef keywords = kNoRef, args = kNoRef, callee = kNoRef;
  if (has_keywords && !pop(keywords)) return false;
  return pop(args) && pop(callee) && push(calls_.call(callee, args));
}

// Class and arguments in one group.
bool PickleMachine::instance(std::vector<PickleRef> items) {
  if (items.empty()) return fail("makes an object without a class");
  const PickleRef callee = items.front();
  items.erase(items.begin());
  const PickleRef args = calls_.add({.kind = PickleKind::tuple, .items = std::move(items)});
  return args != kNoRef && push(calls_.call(callee, args));
}

bool PickleMachine::run() {
  none_ = calls_.add({});
  true_ = calls_.add({.kind = PickleKind::boolean, .integer = 1});
  false_ = calls_.add({.kind = PickleKind::boolean, .integer = 0});
  while (!stopped_) {
    unsigned char opcode = 0;
    if (!number(opcode) || !step(opcode)) return false;
  }
  if (stack_.size() != 1 || !marks_.empty()) return fail("ends with unfinished values");
  heap_.root = stack_.back();
  heap_.size = position_;
  return true;
}

}  // namespace mien
