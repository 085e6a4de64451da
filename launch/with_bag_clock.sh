#!/bin/sh
# Runs rosbag play --clock, whose command line is given, and takes /use_sim_time off the master when it
# ends, also by Ctrl-C: whoever starts after it would wait for a clock that ticks no more.
trap : INT TERM
"$@"
status=$?
rosparam delete /use_sim_time
exit $status
