#pragma once
#include <cstdint>
#include <stdexcept>
#include <string>

#include "backend.h"
#include "mien/models/said/network.h"

namespace mien::parity {

/// The recorded weights that the cases of SAiD were made with, and the sizes that they tell.
inline constexpr const char* kSaidWeights = "model_small.safetensors";

template <class T>
said::Network<T> said_network(const Fixture& weights, bool is_aligned = true) {
  auto sizes = said::sizes_of(weights.file());
  if (!sizes) throw std::runtime_error(sizes.error().message());
  sizes->is_aligned = is_aligned;
  return Backend<T>::load(weights, said::Network<T>(*sizes));
}

/// Runs body(prefix) for "case0.", "case1." ... as long as the file has one; gives their number.
template <class Body>
int for_each_said_case(const Fixture& recorded, const char* tensor, Body&& body) {
  int count = 0;
  for (;; ++count) {
    std::string prefix = "case";
    prefix.append(std::to_string(count)).append(1, '.');
    if (!recorded.has(prefix + tensor)) return count;
    SCOPED_TRACE(prefix);
    body(prefix);
  }
}

/// Whether the recorded cases of SAiD are there; a test that needs them is skipped by name without.
inline bool has_said(const std::string& file) {
  std::error_code absent;
  return std::filesystem::exists(fixture_root() / "said" / file, absent);
}

}  // namespace mien::parity
