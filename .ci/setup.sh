# Sourced by ./run and ./test: installs what is missing, builds, sets up the environment.

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build="$root/build"
# Most sources are compiled sixteen at a time: what they instantiate of Eigen and ROS once.
build_options=(-DCMAKE_BUILD_TYPE=Release -DCMAKE_UNITY_BUILD=ON -DCMAKE_UNITY_BUILD_BATCH_SIZE=16)
export PATH="/usr/bin:$PATH"  # another python3 in front of the system's breaks catkin

say() { echo "$(basename "$0"): $*" >&2; }
die() { say "$@"; exit 1; }

# Debian packages the ROS packages one by one; ROS Noetic has its own names for them on Ubuntu.
needed_packages() {
  local package
  echo build-essential clang cmake ninja-build python3 libeigen3-dev libyaml-cpp-dev \
    nlohmann-json3-dev libtbb-dev libboost-program-options-dev libgtest-dev libgmock-dev gnuplot-nox \
    libopengl-dev qtbase5-dev xvfb pybind11-dev python3-dev python3-numpy \
    libhdf5-dev python3-h5py python3-distributed
  if is_noetic; then
    for package in catkin diagnostic-msgs diagnostic-updater dynamic-reconfigure geometry-msgs \
        interactive-markers message-generation message-runtime rosbag rosbag-storage rosbash \
        roscpp rosgraph-msgs roslaunch roslib rosmsg rosnode rosparam rosservice rostest rostopic \
        rviz sensor-msgs std-msgs std-srvs tf2 tf2-eigen tf2-geometry-msgs tf2-msgs tf2-ros \
        visualization-msgs; do
      echo "ros-noetic-$package"
    done
    return
  fi
  echo catkin rosbash rviz python3-rosbag python3-roslaunch python3-rosmsg \
    python3-rosnode python3-rosparam python3-rosservice python3-rostest python3-rostopic
  echo libdiagnostic-updater-dev libdynamic-reconfigure-config-init-mutex-dev \
    libinteractive-markers-dev librosbag-dev librosbag-storage-dev libroscpp-dev libroslib-dev \
    librostest-dev librviz-dev libtf2-dev libtf2-eigen-dev libtf2-geometry-msgs-dev libtf2-ros-dev
  echo python3-dynamic-reconfigure python3-tf2-ros ros-message-generation ros-message-runtime
  # Of each message package: the headers, the definitions, the python classes.
  for package in diagnostic-msgs geometry-msgs sensor-msgs std-msgs std-srvs tf2-msgs \
      visualization-msgs; do
    echo "lib$package-dev" "ros-$package" "python3-$package"
  done
  echo libros-rosgraph-msgs-dev ros-rosgraph-msgs python3-rosgraph-msgs
}

is_noetic() {
  [ -d /opt/ros/noetic ] || grep -qs '^UBUNTU_CODENAME=focal' /etc/os-release
}

# Those of the arguments that are not installed.
not_installed() {
  local installed package
  installed=" $(echo $(dpkg-query -W -f='${db:Status-Status} ${Package}\n' "$@" 2>/dev/null |
    sed -n 's/^installed //p')) "
  for package in "$@"; do
    [[ $installed == *" $package "* ]] || echo "$package"
  done
}

install_missing() {
  command -v dpkg-query >/dev/null || die "needs Debian 11 or 12, or Ubuntu with ROS Noetic"
  local missing as_root=() log
  missing=$(not_installed $(needed_packages))
  [ -z "$missing" ] && return
  missing=$(echo $missing)  # on one line
  if [ "$(id -u)" != 0 ]; then
    as_root=(sudo)
    [ -t 0 ] || as_root=(sudo -n)
    "${as_root[@]}" true 2>/dev/null ||
      die "needs root or sudo to install missing packages: apt-get install $missing"
  fi
  say "installing $(wc -w <<<"$missing") packages and what they need; this takes a few minutes once"
  log=$(mktemp)
  "${as_root[@]}" apt-get -qq update >"$log" 2>&1 || say "apt-get update failed, trying to install"
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq -y --no-install-recommends \
    install $missing >>"$log" 2>&1 || grep '^E:' "$log" >&2
  rm -f "$log"
  missing=$(not_installed $missing)
  [ -z "$missing" ] && return
  is_noetic && say "on Ubuntu 20.04 the packages of ROS come from http://packages.ros.org"
  die "apt-get could not install missing packages:" $missing
}

# Whether nothing has changed since the file: no file or folder of the tree, no system package. The
# build itself takes a second to find that out, as catkin checks every message anew.
is_newest() {
  [ -f "$1" ] && [ -z "$(find "$root" /var/lib/dpkg/status \
    \( -path "$root/build*" -o -path "$root/.git" \) -prune -o -newer "$1" -print -quit 2>&1)" ]
}

# Configures the tree as one catkin project and builds the given targets.
build_targets() {
  local cache="$build/CMakeCache.txt" built="$build/devel/.built-$*" options="$build/options"
  if [ -f "$cache" ] && ! grep -qxF "CMAKE_HOME_DIRECTORY:INTERNAL=$root" "$cache"; then
    say "$(basename "$build")/ belongs to another folder, building anew"
    rm -rf "$build"
  fi
  if [ -f "$options" ] && [ "$(cat "$options")" != "${build_options[*]}" ]; then
    say "$(basename "$build")/ was configured with other options, building anew"
    rm -rf "$build"
  fi
  is_newest "$built" && return
  if [ ! -f "$build/build.ninja" ] && [ ! -f "$build/Makefile" ]; then
    mkdir -p "$build"
    say "configuring (log: $(basename "$build")/configure.log)"
    cmake -S "$root" -B "$build" -G Ninja "${build_options[@]}" \
      -DPYTHON_EXECUTABLE=/usr/bin/python3 >"$build/configure.log" 2>&1 ||
      { tail -n 30 "$build/configure.log" >&2; return 1; }
    echo "${build_options[*]}" >"$options"
  fi
  touch "$build/now"
  # The filter leaves out what is done in every build and changes nothing.
  cmake --build "$build" --parallel "$(nproc)" --target "$@" 2>&1 |
    sed -u '/genmsg_check_deps\|^ninja: no work\|Re-checking globbed/d'
  [ "${PIPESTATUS[0]}" = 0 ] && mv "$build/now" "$built"
}

# From here on: a build folder of its own with asserts and the given sanitizers (as -fsanitize has
# them), which write what they find to files in it. Of `undefined` those are left out that the
# address sanitizer stands in for and that make Eigen slow to compile. Without the plugins for rviz,
# which is built without sanitizers and so cannot load them. Eigen aligns memory by hand only under
# the address sanitizer, and a library of ROS (orocos-kdl) brings the same functions of Eigen built
# without: what one allocates the other frees, so both must leave alignment to malloc.
use_sanitizers() {
  build="$root/build_$1"
  build_options=(-DCMAKE_BUILD_TYPE=Sanitize -DCMAKE_DISABLE_FIND_PACKAGE_rviz=ON
    -DCMAKE_CXX_FLAGS="-O1 -g1 -fno-omit-frame-pointer -D_GLIBCXX_ASSERTIONS \
      -DEIGEN_MALLOC_ALREADY_ALIGNED=1 -fsanitize=$2 \
      -fno-sanitize=null,alignment,object-size,pointer-overflow,vptr")
  local options="log_path=$build/reports/$1"
  export RAGDOLL_SANITIZED=$1 RAGDOLL_TIME_LIMIT=2000
  export ASAN_OPTIONS="$options:detect_stack_use_after_return=1"
  export UBSAN_OPTIONS="$options:halt_on_error=1:print_stacktrace=1"
  export TSAN_OPTIONS="$options:second_deadlock_stack=1:suppressions=$root/.ci/thread_sanitizer.txt"
}

# ROS on loopback only, unless the user has said where ROS lives. A ROS_MASTER_URI on localhost is
# what ROS's own setup file writes and says nothing.
bind_to_loopback() {
  case "${ROS_MASTER_URI:-http://localhost}" in
    http://localhost* | http://127.*) ;;
    *) return ;;
  esac
  [ -n "${ROS_IP:-}${ROS_HOSTNAME:-}" ] || export ROS_IP=127.0.0.1
  export ROS_MASTER_URI="${ROS_MASTER_URI:-http://127.0.0.1:11311}"
}

# Everything up to a shell in which the given targets are built and roslaunch works.
set_up() {
  install_missing
  # Another workspace of the user's is not part of this build.
  unset CMAKE_PREFIX_PATH ROS_PACKAGE_PATH
  bind_to_loopback
  if [ -f /opt/ros/noetic/setup.bash ]; then . /opt/ros/noetic/setup.bash; fi
  build_targets "$@" || return 1
  . "$build/devel/setup.bash"
}
