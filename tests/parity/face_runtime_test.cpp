// FaceXHuBERT and FaceDiffuser, with its emotional form, on the runtime.
#include "emotional_diffuser_suite.h"
#include "face_chain_suite.h"
#include "facediffuser_suite.h"
#include "facexhubert_suite.h"
#include "runtime_backend.h"

namespace mien::parity {

INSTANTIATE_TYPED_TEST_SUITE_P(Runtime, FaceDiffuser, Tensor);
INSTANTIATE_TYPED_TEST_SUITE_P(Runtime, FaceXHuBert, Tensor);
INSTANTIATE_TYPED_TEST_SUITE_P(Runtime, FaceChain, Tensor);
INSTANTIATE_TYPED_TEST_SUITE_P(Runtime, EmotionalFaceDiffuser, Tensor);

}  // namespace mien::parity
