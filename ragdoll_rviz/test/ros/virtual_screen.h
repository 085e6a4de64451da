// A screen of its own for rviz, by Xvfb; whatever screens there are.
#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <string>

namespace ragdoll_test {

class VirtualScreen {
 public:
  /// Sets DISPLAY. Needs a process that has no thread yet.
  VirtualScreen() {
    int ends[2];
    if (pipe(ends) != 0) return;
    process_ = fork();
    if (process_ == 0) {
      close(ends[0]);
      const std::string fd = std::to_string(ends[1]);
      execlp("Xvfb", "Xvfb", "-displayfd", fd.c_str(), "-screen", "0", "1400x900x24", "-nolisten",
             "tcp", static_cast<char*>(nullptr));
      _exit(1);
    }
    close(ends[1]);
    std::string number;  // comes with a newline once the screen is there
    char c = 0;
    while (read(ends[0], &c, 1) == 1 && c != '\n') number += c;
    close(ends[0]);
    there_ = c == '\n';
    if (there_) setenv("DISPLAY", (":" + number).c_str(), 1);
  }
  ~VirtualScreen() {
    if (process_ <= 0) return;
    kill(process_, SIGTERM);
    waitpid(process_, nullptr, 0);
  }

  /// False where there is no Xvfb.
  bool there() const { return there_; }

 private:
  pid_t process_ = 0;
  bool there_ = false;
};

}  // namespace ragdoll_test
