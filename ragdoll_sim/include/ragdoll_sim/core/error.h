// What a user's file, parameter or request got wrong: where, what, and what would be right.
// Thrown by loaders and by buildModel; nothing has been changed when it is thrown.
#pragma once

#include <stdexcept>
#include <string>

namespace ragdoll {

class Error : public std::runtime_error {
 public:
  static constexpr std::size_t kLongest = 4000;  ///< bytes of a message; its middle is left out

  /// where: "file.yaml:12: sticks[3]" or a name; what: the fault and what would be right.
  Error(const std::string& where, const std::string& what)
      : std::runtime_error(shortened(where.empty() ? what : where + ": " + what)), where_(where) {}
  const std::string& where() const { return where_; }

 private:
  static std::string shortened(const std::string& text) {
    if (text.size() <= kLongest) return text;
    return text.substr(0, kLongest / 2) + " ... " + text.substr(text.size() - kLongest / 2);
  }

  std::string where_;
};

}  // namespace ragdoll
