#pragma once
#include <atomic>
#include <cstdint>
#include <string_view>

namespace mien {

/// Where long work reports how far it is, and asks whether to stop. The library never prints; the program derives
/// from this to draw a bar or write JSON lines. Calls come from one thread at a time.
class Progress {
 public:
  virtual ~Progress() = default;
  /// A new stage begins; `total` units of work, 0 when unknown.
  virtual void stage(std::string_view name, std::int64_t total) { (void)name, (void)total; }
  /// `done` units of the current stage are finished.
  virtual void update(std::int64_t done) { (void)done; }
  /// Something survivable happened.
  virtual void warn(std::string_view message) { (void)message; }
  /// True after cancel(): stop at the next safe point and return Errc::cancelled.
  [[nodiscard]] bool cancelled() const { return cancelled_.load(std::memory_order_relaxed); }
  /// Safe to call from a signal handler.
  void cancel() { cancelled_.store(true, std::memory_order_relaxed); }

 private:
  std::atomic<bool> cancelled_{false};
};

}  // namespace mien
