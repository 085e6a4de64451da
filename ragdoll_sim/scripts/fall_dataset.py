#!/usr/bin/python3
"""Records random falls of a standing body: a bag each, and labels.csv with one row for each.

Needs a paused ragdoll_node; fall_dataset.launch starts one. Drives it by ~load_scene and ~step, so a
fall lasts as long as its computation, and the same seed gives the same states to the bit. A bag holds
~model, ~state (header.stamp is the simulated time, from EPOCH on) and the labels as JSON on ~label; it
plays (playback.launch) and replays (ragdoll_lab replay).

Labels: seed; start: yaw, pitch, roll [deg], friction of the floor; push: body, force [N, world], begin
and duration [s]; impact: time [s] of the first state in which another part than a foot touches the
floor, that part, its speed [m/s] one state before; end: pose class, height of the head [m], and
whether the body rests. Empty where it did not happen.
"""

import argparse
import csv
import json
import math
import os
import random
import sys

import rosbag
import rospy
import yaml
from ragdoll_msgs.msg import Model
from ragdoll_msgs.srv import GetState, LoadScene, Step
from std_msgs.msg import String
from std_srvs.srv import SetBool

EPOCH = 1.0       # [s] stamp of the start: a stamp of 0 means "now" to many
TOUCH = 0.002     # [m] a particle that is so near to the floor touches it
UPRIGHT = 0.7     # cosine of the trunk's lean up to which the body sits or kneels
FACING = 0.6      # cosine between chest and vertical up to which it lies on its back or front
STANDING = 1.02   # [m] height of the hips with the feet on the floor, leaning a little
FIELDS = ['bag', 'seed', 'start_yaw_deg', 'start_pitch_deg', 'start_roll_deg', 'friction', 'push_body',
          'push_x', 'push_y', 'push_z', 'push_begin', 'push_duration', 'impact_time', 'impact_body',
          'impact_speed', 'end_pose', 'end_head_height', 'at_rest']


def draw(seed):
    """What is random about a fall: the labels that are known before it."""
    rng = random.Random(seed)
    direction, force = rng.uniform(-math.pi, math.pi), rng.uniform(100, 500)
    return {
        'seed': seed,
        'start_yaw_deg': rng.uniform(-180, 180),
        'start_pitch_deg': rng.uniform(-4, 4),
        'start_roll_deg': rng.uniform(-4, 4),
        'friction': rng.uniform(0.4, 0.9),
        'push_body': rng.choice(['torso', 'head', 'left_shoulder', 'right_shoulder', 'pelvis']),
        'push_x': force * math.cos(direction),
        'push_y': force * math.sin(direction),
        'push_z': 0.0,
        'push_begin': rng.uniform(0, 0.3),
        'push_duration': rng.uniform(0.1, 0.3)}


def scene(fall):
    return yaml.safe_dump({
        'ragdolls': [{'name': 'ragdoll', 'model': 'human', 'position': [0, 0, STANDING],
                      'rpy_deg': [fall['start_roll_deg'], fall['start_pitch_deg'],
                                  fall['start_yaw_deg']]}],
        'obstacles': [{'type': 'plane', 'friction': fall['friction']}],
        'pokes': [{'at': fall['push_begin'], 'body': fall['push_body'],
                   'force': [fall['push_x'], fall['push_y'], fall['push_z']],
                   'duration': fall['push_duration']}],
        'self_collision': True,
        'solver': {'joint_damping': 2}})


def point(p):
    return (p.x, p.y, p.z)


def minus(a, b):
    return tuple(x - y for x, y in zip(a, b))


def unit(a):
    length = math.sqrt(sum(x * x for x in a))
    return tuple(x / length for x in a)


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def pose_class(at):
    """How a body lies, from its particles' positions [m, world] by name."""
    hips = tuple((a + b) / 2 for a, b in zip(at['left_hip'], at['right_hip']))
    up = unit(minus(at['neck'], hips))
    left = unit(minus(at['left_shoulder'], at['right_shoulder']))
    front = unit(cross(left, up))
    if up[2] > UPRIGHT:
        return 'upright'
    if abs(front[2]) > FACING:
        return 'supine' if front[2] > 0 else 'prone'
    return 'on_right_side' if left[2] > 0 else 'on_left_side'


def impact(states, names, radii):
    """Labels of the first touch of the floor by anything but a foot."""
    for before, state in zip(states, states[1:]):
        ragdoll = state.ragdolls[0]
        gaps = [(p.z - radius, i) for i, (p, radius) in enumerate(zip(ragdoll.positions, radii))
                if not names[i].endswith('foot')]
        gap, i = min(gaps)
        if gap < TOUCH:
            speed = math.sqrt(sum(v * v for v in point(before.ragdolls[0].velocities[i])))
            return {'impact_time': state.time, 'impact_body': names[i], 'impact_speed': speed}
    return {'impact_time': '', 'impact_body': '', 'impact_speed': ''}


class Recorder:
    def __init__(self, node, seconds, rate):
        self.node, self.seconds, self.rate = node, seconds, rate
        self.load = self.service('load_scene', LoadScene)
        self.step = self.service('step', Step)
        self.get = self.service('get_state', GetState)
        if not self.service('pause', SetBool)(True).success:
            raise RuntimeError('the node does not pause')

    def service(self, name, kind):
        rospy.wait_for_service(self.node + '/' + name, 30)
        return rospy.ServiceProxy(self.node + '/' + name, kind, persistent=True)

    def begin(self, fall):
        """Its first state and the length of a step [s], which is the first one made."""
        answer = self.load(yaml=scene(fall))
        if not answer.success:
            raise RuntimeError(answer.status_message)
        first = self.get().state
        self.step(1)
        return first, self.get().state.time

    def simulate(self, fall):
        """(model, states) of a fall."""
        first, h = self.begin(fall)
        states, done, each = [first], 1, self.steps_per_state(h)
        for step in range(each, int(round(self.seconds / h)) + 1, each):
            self.step(step - done)
            states.append(self.get().state)
            done = step
        model = rospy.wait_for_message(self.node + '/model', Model, 30)
        return model, states

    def steps_per_state(self, h):
        """States are those of whole steps [s]: a rate that does not fit would be another one."""
        steps = 1 / (self.rate * h)
        each = max(1, int(round(steps)))
        if abs(steps - each) > 1e-3 * each:
            near = sorted({max(1, int(steps)), int(steps) + 1})
            sys.exit('fall_dataset: --rate %g does not fit steps of %g s: it can be %s Hz' % (
                self.rate, h, ' or '.join('%g' % (1 / (n * h)) for n in near)))
        return each

    def record(self, path, fall):
        """Writes the bag of a fall; returns all its labels."""
        model, states = self.simulate(fall)
        names = model.ragdolls[0].particles
        particles = yaml.safe_load(model.scene_yaml)['ragdolls'][0]['model']['particles']
        last = dict(zip(names, (point(p) for p in states[-1].ragdolls[0].positions)))
        labels = dict(fall, bag=os.path.basename(path), end_pose=pose_class(last),
                      end_head_height=last['head'][2], at_rest=states[-1].ragdolls[0].asleep)
        labels.update(impact(states, names, [particles[n].get('radius', 0) for n in names]))
        with rosbag.Bag(path, 'w') as bag:
            self.write(bag, 'model', model, 0, latching='1')
            self.write(bag, 'label', String(json.dumps(labels, sort_keys=True)), 0, latching='1')
            for state in states:
                self.write(bag, 'state', state, state.time)
        return labels

    def write(self, bag, name, message, time, **header):
        """Stamps and run numbers are those of this fall, whatever the node did before."""
        stamp = rospy.Time.from_sec(EPOCH + time)
        if hasattr(message, 'header'):
            message.header.stamp, message.header.seq, message.run = stamp, 0, 0
        topic = self.node + '/' + name
        header.update(topic=topic, type=message._type, md5sum=message._md5sum,
                      message_definition=message._full_text, callerid=self.node)
        bag.write(topic, message, stamp, connection_header=header)


def read_arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('--falls', type=int, default=10, help='how many')
    parser.add_argument('--seed', type=int, default=1, help='of the first fall')
    parser.add_argument('--seconds', type=float, default=5, help='length of a fall [s]')
    parser.add_argument('--rate', type=float, default=60, help='states per second [Hz]')
    parser.add_argument('--out', default='falls', help='folder for bags and labels.csv')
    parser.add_argument('--node', default='/ragdoll', help='name of the ragdoll_node')
    arguments = parser.parse_args(rospy.myargv()[1:])
    if arguments.falls < 1 or not 0 < arguments.seconds <= 3600 or not 0 < arguments.rate <= 10000:
        parser.error('--falls must be at least 1, --seconds in (0, 3600], --rate in (0, 10000]')
    return arguments


def main():
    arguments = read_arguments()
    table = os.path.join(arguments.out, 'labels.csv')
    if os.path.exists(table):
        sys.exit('fall_dataset: %s is there already: name another folder' % table)
    os.makedirs(arguments.out, exist_ok=True)
    rospy.init_node('fall_dataset')
    recorder = Recorder(arguments.node, arguments.seconds, arguments.rate)
    recorder.steps_per_state(recorder.begin(draw(arguments.seed))[1])  # before anything is written
    begin = rospy.get_rostime().to_sec()
    with open(table, 'w', newline='') as file:
        rows = csv.DictWriter(file, FIELDS)
        rows.writeheader()
        for i in range(arguments.falls):
            if rospy.is_shutdown():
                sys.exit(1)
            seed = arguments.seed + i
            labels = recorder.record(os.path.join(arguments.out, 'fall_%06d.bag' % seed), draw(seed))
            rows.writerow(labels)
            file.flush()
            rospy.loginfo('%s: impact at %s s, %s', labels['bag'], labels['impact_time'],
                          labels['end_pose'])
    passed = rospy.get_rostime().to_sec() - begin
    rospy.loginfo('%d falls of %g s in %.1f s: %s', arguments.falls, arguments.seconds, passed, table)


if __name__ == '__main__':
    main()
