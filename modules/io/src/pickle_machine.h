#pragma once
#include <memory>
#include <vector>

#include "pickle_calls.h"

namespace mien {

/// The stack machine that a pickle is written for (Python's Lib/pickletools.py describes it), without the
/// instructions that would act.
class PickleMachine {
 public:
  PickleMachine(std::span<const std::byte> bytes, PickleHeap& heap, bool keep_foreign)
      : bytes_(bytes), heap_(heap), calls_(heap, keep_foreign) {}

  /// Reads up to STOP and fills the heap. False after storing an error.
  bool run();
  [[nodiscard]] Error error() const {
    return calls_.error.value_or(Error{Errc::input, "", "is damaged", ""});
  }

 private:
  bool fail(std::string why) { return calls_.fail(std::move(why)), false; }
  bool truncated() { return fail("ends in the middle"); }

  // Bytes of the file. Each returns false at the end.
  bool take(std::size_t count, std::string_view& out);
  bool line(std::string_view& out);
  template <class T>
  bool number(T& out);
  template <class Length>
  bool counted(std::string_view& out);

  // The stack. Nothing below the last mark is ever taken.
  bool push(PickleRef ref);
  bool push(PickleNode node) { return push(calls_.add(std::move(node))); }
  bool pop(PickleRef& out);
  bool pop_to_mark(std::vector<PickleRef>& out);
  bool top(PickleRef& out);

  bool step(unsigned char opcode);
  bool step_text(unsigned char opcode);       // protocol 0: arguments are lines of text
  bool step_value(unsigned char opcode);      // numbers and strings
  bool step_structure(unsigned char opcode);  // lists, dictionaries, memory, calls

  bool push_long(std::string_view little_endian);
  bool push_decimal(std::string_view digits);
  bool push_tuple(std::size_t count);
  bool remember(std::uint64_t index);
  bool recall(std::uint64_t index);
  bool append(PickleKind kind, std::vector<PickleRef> items);
  bool call_top(bool has_keywords);
  bool instance(std::vector<PickleRef> items);

  std::span<const std::byte> bytes_;
  std::size_t position_ = 0;
  PickleHeap& heap_;
  PickleCalls calls_;
  std::vector<PickleRef> stack_;
  std::vector<std::size_t> marks_;
  std::vector<PickleRef> memory_;
  std::size_t remembered_ = 0;
  PickleRef none_ = kNoRef, true_ = kNoRef, false_ = kNoRef;
  bool stopped_ = false;
};

template <class T>
bool PickleMachine::number(T& out) {
  const auto value = read_le<T>(bytes_, position_);
  if (!value) return truncated();
  out = *value;
  position_ += sizeof(T);
  return true;
}

template <class Length>
bool PickleMachine::counted(std::string_view& out) {
  Length length = 0;
  return number(length) && take(static_cast<std::size_t>(length), out);
}

}  // namespace mien
