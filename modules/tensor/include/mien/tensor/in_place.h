#pragma once
#include <cstdint>
#include <span>

#include "mien/tensor/tensor.h"

// Operations of ops.h on memory that the caller owns, for fast paths that work block by block. Same bits.
namespace mien {

void gelu_in_place(std::span<float> values);
void silu_in_place(std::span<float> values);
/// x = layer_norm(x), or layer_norm(x + added) when `added` is given.
/// @param x  [rows, width], one after the other. @pre x.size() is a multiple of the width of gamma and beta
/// @param added  empty, or as many values as x
void layer_norm_in_place(std::span<float> x, std::span<const float> added, const Tensor& gamma,
                         const Tensor& beta, double eps = 1e-5);
/// x += y. @pre equal sizes
void add_in_place(std::span<float> x, std::span<const float> y);

}  // namespace mien
