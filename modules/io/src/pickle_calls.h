#pragma once
#include <optional>
#include <string>
#include <unordered_map>

#include "pickle_heap.h"

namespace mien {

/// What a pickle asks for by name, for the few names that are data and not programs. Functions that return a
/// PickleRef give kNoRef, and those that return bool false, after storing `error`.
class PickleCalls {
 public:
  PickleCalls(PickleHeap& heap, bool keep_foreign) : heap_(heap), keep_foreign_(keep_foreign) {}

  /// A new value. Errors: more values than any real file has.
  PickleRef add(PickleNode node);
  /// Accounts for `count` references that are about to be stored.
  bool spend(std::size_t count);

  PickleRef global(std::string_view module, std::string_view name);
  /// @param args  a tuple
  PickleRef call(PickleRef callee, PickleRef args);
  bool build(PickleRef object, PickleRef state);
  /// @param id  what torch.save put in place of a storage
  PickleRef persistent(PickleRef id);

  PickleRef fail(std::string why, Errc code = Errc::input) {
    if (!error) error = Error{code, "", std::move(why), ""};
    return kNoRef;
  }
  std::optional<Error> error;

 private:
  PickleNode& node(PickleRef ref) { return heap_.nodes[ref]; }
  [[nodiscard]] const std::vector<PickleRef>& items(PickleRef ref) const { return heap_.nodes[ref].items; }
  std::optional<std::int64_t> integer(PickleRef ref);
  std::optional<std::vector<std::int64_t>> sizes(PickleRef ref);
  std::optional<std::string_view> text(PickleRef ref);

  PickleRef foreign(std::string_view name, PickleRef args);
  PickleRef collect(PickleKind kind, PickleRef args);
  PickleRef ordered_dict(PickleRef args);
  PickleRef encode(PickleRef args);
  PickleRef byte_array(PickleRef args);
  PickleRef numpy_dtype(PickleRef args);
  PickleRef numpy_scalar(PickleRef args);
  PickleRef numpy_from_buffer(PickleRef args);
  PickleRef add_array(PickleArray array);
  bool build_dtype(PickleRef object, PickleRef state);
  bool build_array(PickleRef object, PickleRef state);
  bool check_array(const PickleArray& array);
  PickleRef torch_tensor(PickleRef args, bool has_dtype);

  PickleHeap& heap_;
  bool keep_foreign_;
  std::size_t references_ = 0;
  std::unordered_map<std::string, PickleRef> globals_;
};

}  // namespace mien
