#pragma once
#include "mien/base/contract.h"

namespace mien {

/// contract() for hot paths: the message, a function, is only made when it is needed.
template <class Message>
void require(bool holds, Message&& message) {
  if (!holds) [[unlikely]]
    contract(false, message());
}

}  // namespace mien
