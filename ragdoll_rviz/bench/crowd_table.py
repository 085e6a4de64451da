#!/usr/bin/python3
"""Prints the table "What a crowd costs" of docs/rviz_tables.md: a node and rviz for 1, 20, 200 and 1000 bodies.

crowd_table.py [--seconds S] [--markers] [--smooth] [BODIES ...]. Needs an environment with the packages, the target
view_bench, Xvfb, and a machine with nothing else to do; starts a roscore of its own.
"""

import argparse
import os
import subprocess
import tempfile
import time

import rospy

PORT = 11977
SCENE = """ragdolls:
  - {name: crowd, model: human, count: %d, spacing: [1.6, 1.6, 0], position: [0, 0, 2.0], rpy_deg: [10, 25, 0]}
obstacles:
  - {type: plane, friction: 0.6}
solver: {preset: %s, joint_damping: 2, sleep: false}
"""
MANY = 50  # bodies from which on the preset is fast
WARM_UP = 6  # [s]
ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), '..', '..')
PROGRAMS = os.path.join(os.environ['CMAKE_PREFIX_PATH'].split(':')[0], 'lib')


def cpu_seconds(pid):
    with open('/proc/%d/stat' % pid) as f:
        fields = f.read().rsplit(')', 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf('SC_CLK_TCK')


def memory(pid):
    """[MB] at most so far."""
    with open('/proc/%d/status' % pid) as f:
        return next(int(line.split()[1]) for line in f if line.startswith('VmHWM')) / 1024


def heard_per_second(topics, seconds):
    """[bytes] What rviz hears of these topics, heard by another that has taken its place."""
    sizes = []
    subscribers = [rospy.Subscriber(topic, rospy.AnyMsg, lambda m: sizes.append(len(m._buff)), queue_size=None)
                   for topic in topics]
    time.sleep(2)  # what is told once has been told
    sizes.clear()
    time.sleep(seconds)
    total = sum(sizes)
    for subscriber in subscribers:
        subscriber.unregister()
    return total / seconds


def viewed(bodies, folder, markers):
    """The shipped view, looking at all of them."""
    with open(os.path.join(ROOT, 'rviz', 'crowd.rviz')) as f:
        view = f.read()
    if markers:
        view = view.replace('Topic: /ragdoll/scenery', 'Topic: /ragdoll/markers')
        view = view.replace('Coat: node\'s', 'Coat: none')
    side = 1.6 * bodies ** 0.5
    view = view.replace('Distance: 15', 'Distance: %g' % (3 + 1.6 * side))
    view = view.replace('        X: 3\n        Y: 3.2\n', '        X: %g\n        Y: %g\n' % (side / 2, side / 2))
    path = os.path.join(folder, 'view.rviz')
    with open(path, 'w') as f:
        f.write(view)
    return path


def measure(bodies, seconds, markers, arguments):
    with tempfile.TemporaryDirectory() as folder:
        scene = os.path.join(folder, 'scene.yaml')
        preset = 'fast' if bodies > MANY else 'balanced'
        with open(scene, 'w') as f:
            f.write(SCENE % (bodies, preset))
        node = subprocess.Popen([os.path.join(PROGRAMS, 'ragdoll_sim', 'ragdoll_node'), '__name:=ragdoll',
                                 '_scene:=' + scene], stdout=subprocess.DEVNULL)
        time.sleep(2)
        view = subprocess.Popen([os.path.join(PROGRAMS, 'ragdoll_rviz', 'view_bench'),
                                 viewed(bodies, folder, markers), str(seconds + 2), str(WARM_UP)] + arguments,
                                stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, universal_newlines=True)
        time.sleep(WARM_UP + 2)
        cpu, begin = cpu_seconds(node.pid), time.time()
        time.sleep(seconds - 2)
        passed = time.time() - begin
        cpu = cpu_seconds(node.pid) - cpu
        metrics = subprocess.run(['timeout', '20', 'rostopic', 'echo', '-n1', '/ragdoll/metrics/realtime_factor'],
                                 stdout=subprocess.PIPE, universal_newlines=True).stdout.split()[0]
        rate, view_cpu, view_memory = [float(x) for x in view.communicate()[0].split()[-3:]]
        bodies_topics = ['/ragdoll/markers'] if markers else ['/ragdoll/state', '/ragdoll/scenery']
        heard = heard_per_second(['/tf', '/ragdoll/metrics', '/ragdoll/handles/update'] + bodies_topics, 3) / 1e6
        row = (bodies, preset, float(metrics), 100 * cpu / passed, memory(node.pid), heard, rate,
               view_cpu, view_memory)
        node.terminate()
        node.wait()
        return row


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('bodies', nargs='*', type=int, default=[1, 20, 200, 1000])
    parser.add_argument('--seconds', type=float, default=20)
    parser.add_argument('--markers', action='store_true', help='bodies as markers, without the display')
    parser.add_argument('--smooth', action='store_true', help='smooth edges: antialiasing:=true')
    parser.add_argument('--pictures', help='folder for a screenshot of each')
    args = parser.parse_args()
    os.environ.update(ROS_MASTER_URI='http://127.0.0.1:%d' % PORT, ROS_IP='127.0.0.1')
    core = subprocess.Popen(['roscore', '-p', str(PORT)], stdout=subprocess.DEVNULL)
    time.sleep(4)
    rospy.init_node('crowd_table')
    try:
        print('| bodies | preset | real time | node CPU | node memory | told | pictures | rviz CPU | rviz memory |')
        print('|---|---|---|---|---|---|---|---|---|')
        for bodies in args.bodies:
            arguments = [os.path.join(args.pictures, 'crowd_%d.png' % bodies)] if args.pictures else []
            arguments += ['--smooth'] if args.smooth else []
            print('| %d | %s | x %.2f | %.1f %% | %.0f MB | %.2f MB/s | %.1f/s | %.0f %% | %.0f MB |' %
                  measure(bodies, args.seconds, args.markers, arguments), flush=True)
    finally:
        core.terminate()
        core.wait()


if __name__ == '__main__':
    main()
