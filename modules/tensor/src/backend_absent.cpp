// Stands in for the backends whose library the build did not find.
#include "backends.h"
#include "mien/base/contract.h"

namespace mien {

#ifndef MIEN_HAS_EIGEN
bool eigen_available() { return false; }
KernelPtr make_eigen_kernel(const float*, std::int64_t, std::int64_t) {
  contract(false, "this build has no Eigen");
  return nullptr;
}
#endif

#ifndef MIEN_HAS_ONEDNN
bool onednn_available(Backend) { return false; }
KernelPtr make_onednn_kernel(const float*, std::int64_t, std::int64_t, Backend) {
  contract(false, "this build has no oneDNN");
  return nullptr;
}
#endif

}  // namespace mien
