#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

// Which code stands for a chunk of the latent: the nearest, or one drawn at random (ProbTalk3D, section 4.3).
namespace mien::probtalk3d {

/// For each row of distances [M, K] the index of the smallest; the first of equal ones.
std::vector<std::int64_t> nearest_codes(std::span<const float> distances, std::int64_t num_codes);

/// softmax(-distances / temperature) by rows [M, K]. @pre temperature > 0
std::vector<float> code_probabilities(std::span<const float> distances, std::int64_t num_codes,
                                      double temperature);

/// Numbers of the exponential distribution with mean 1, all above 0: one for every code of a chunk.
using CodeRace = std::function<void(std::int64_t chunk, std::span<float> out)>;

/// Draws a code for each row of probabilities [M, K] by an exponential race: the code with the largest
/// p / r wins with probability p. `place` k > 1 takes the k-th of the race, which is the last of k codes
/// drawn without replacement; where fewer than k have a probability, the last that has. @pre place >= 1
std::vector<std::int64_t> draw_codes(std::span<const float> probabilities, std::int64_t num_codes, int place,
                                     const CodeRace& race);

}  // namespace mien::probtalk3d
