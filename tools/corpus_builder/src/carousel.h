#pragma once
#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "mien/base/random.h"
#include "sentence_bank.h"

namespace mien {

/// Walks through a list in a random order, again and again, so that every sentence is used about equally
/// often. The list must outlive it.
class Carousel {
 public:
  Carousel(const std::vector<std::string>& sentences, Rng& rng);
  [[nodiscard]] bool empty() const { return order_.empty(); }
  /// @pre not empty
  const std::string& next();
  /// As many sentences as surely fill `seconds`; none when empty.
  std::vector<std::string> take(double seconds);

 private:
  const std::vector<std::string>* sentences_;
  std::vector<std::size_t> order_;
  std::size_t at_ = 0;
};

/// The carousels of a whole bank.
struct Carousels {
  Carousels(const SentenceBank& bank, Rng& rng);
  Carousel english;
  std::map<std::string, Carousel> babble;
};

}  // namespace mien
