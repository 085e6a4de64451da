// How a service answers: the call itself always goes well; a request that cannot be honoured gets
// success=false and a message that says what was wrong and what would be right.
#pragma once

#include <cstdint>
#include <exception>
#include <string>

namespace ragdoll {

/// `action` returns the message of success, or throws and then has changed nothing.
template <class Action>
bool answer(Action action, std::uint8_t& success, std::string& message) {
  try {
    message = action();
    success = true;
  } catch (const std::exception& e) {
    message = e.what();
    success = false;
  }
  return true;
}

}  // namespace ragdoll
