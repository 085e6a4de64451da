#!/bin/sh
# Runs rosbag record, whose command line is given, and puts the node's namespace before ragdoll/state and the
# like: rosbag writes names of topics into the bag as they are given.
for word in "$@"; do
  shift
  case "$word" in
    ragdoll/*) word="${ROS_NAMESPACE%/}/$word" ;;
  esac
  set -- "$@" "$word"
done
exec "$@"
