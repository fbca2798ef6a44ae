#include "build_kind.h"

namespace mien {

bool has_address_sanitizer() {
#ifdef __SANITIZE_ADDRESS__
  return true;
#else
  return false;
#endif
}

}  // namespace mien
