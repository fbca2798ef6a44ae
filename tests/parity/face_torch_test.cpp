// The suites of FaceXHuBERT and FaceDiffuser on LibTorch.
#include "emotional_diffuser_suite.h"
#include "face_chain_suite.h"
#include "facediffuser_suite.h"
#include "facexhubert_suite.h"
#include "torch_backend.h"

namespace mien::parity {

INSTANTIATE_TYPED_TEST_SUITE_P(LibTorch, FaceDiffuser, torch::Tensor);
INSTANTIATE_TYPED_TEST_SUITE_P(LibTorch, FaceXHuBert, torch::Tensor);
INSTANTIATE_TYPED_TEST_SUITE_P(LibTorch, FaceChain, torch::Tensor);
INSTANTIATE_TYPED_TEST_SUITE_P(LibTorch, EmotionalFaceDiffuser, torch::Tensor);

}  // namespace mien::parity
