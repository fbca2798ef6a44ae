#include "inflate.h"

namespace mien {

Result<Bytes> inflate(std::span<const std::byte>, std::size_t) {
  return Error{Errc::failed, "", "is compressed, and this Mien was built without zlib",
               "Unpack the archive and pack it again without compression, or build with zlib1g-dev"};
}

}  // namespace mien
