#pragma once

#include <string>

#include "ragdoll_sim/core/error.h"

namespace ragdoll::test {

/// The message of the Error that a call throws; "" if it throws none.
template <class Call>
std::string errorOf(const Call& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace ragdoll::test
