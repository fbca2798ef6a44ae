// FaceXHuBERT and FaceDiffuser on the runtime.
#include "face_chain_suite.h"
#include "facediffuser_suite.h"
#include "facexhubert_suite.h"
#include "runtime_backend.h"

namespace mien::parity {

INSTANTIATE_TYPED_TEST_SUITE_P(Runtime, FaceDiffuser, Tensor);
INSTANTIATE_TYPED_TEST_SUITE_P(Runtime, FaceXHuBert, Tensor);
INSTANTIATE_TYPED_TEST_SUITE_P(Runtime, FaceChain, Tensor);

}  // namespace mien::parity
