#!/usr/bin/python3
"""Records random falls: a bag each, and labels.csv with one row for each.

Needs a paused ragdoll_node; fall_dataset.launch starts one. Drives it by ~load_scene and ~step, so a
fall lasts as long as its computation, and the same seed gives the same states to the bit. A bag holds
~model, ~state (header.stamp is the simulated time, from EPOCH on) and the labels as JSON on ~label; it
plays (playback.launch) and replays (ragdoll_lab replay).

The falls are those of `ragdoll_lab falls` (ragdoll.Fall, docs/data.md): the same seed is the same fall,
and with --step 0.005 the same states to the bit. A bag begins at the onset, so times count from there.

Labels: seed; start: yaw, pitch, roll [deg], friction of the floor; push: body, force [N, world], begin
and duration [s]; impact: time [s] of the first state in which another part than a foot touches what
it falls on, that part, its speed [m/s] one state before; end: pose class, height of the head [m], and
whether the body rests; then how it falls, from where, the body's height and mass, walking speed, a
foot that is held or slips. Empty where it did not happen.
"""

import argparse
import csv
import json
import os
import sys

import numpy as np
import ragdoll
import rosbag
import rospy
from ragdoll_msgs.msg import Model
from ragdoll_msgs.srv import Detach, GetState, LoadScene, Step
from std_msgs.msg import String
from std_srvs.srv import SetBool

EPOCH = 1.0       # [s] stamp of the start: a stamp of 0 means "now" to many
FIELDS = ['bag', 'seed', 'start_yaw_deg', 'start_pitch_deg', 'start_roll_deg', 'friction', 'push_body',
          'push_x', 'push_y', 'push_z', 'push_begin', 'push_duration', 'impact_time', 'impact_body',
          'impact_speed', 'end_pose', 'end_head_height', 'at_rest', 'kind', 'start', 'height', 'mass', 'speed',
          'foot', 'foot_hold', 'foot_friction', 'impact_region']


def pose_class(at):
    """How a body lies, from its particles' positions [m, world] by name."""
    return ragdoll.pose_class(at)


def points(messages):
    return np.array([[(p.x, p.y, p.z) for p in message] for message in messages])


class Recorder:
    def __init__(self, node, seconds, rate, step):
        self.node, self.seconds, self.rate, self.h = node, seconds, rate, step
        self.load = self.service('load_scene', LoadScene)
        self.step = self.service('step', Step)
        self.get = self.service('get_state', GetState)
        self.let_go = self.service('detach', Detach)
        if not self.service('pause', SetBool)(True).success:
            raise RuntimeError('the node does not pause')

    def service(self, name, kind):
        rospy.wait_for_service(self.node + '/' + name, 30)
        return rospy.ServiceProxy(self.node + '/' + name, kind, persistent=True)

    def model_of(self, state):
        """The model of the run that the state belongs to."""
        while not rospy.is_shutdown():
            model = rospy.wait_for_message(self.node + '/model', Model, 30)
            if model.run == state.run:
                return model

    def simulate(self, fall):
        """(models, states) of a fall; another model from where what was held is let go on."""
        answer = self.load(yaml=fall.scene)
        if not answer.success:
            raise RuntimeError(answer.status_message)
        states = [self.get().state]
        models = [(0, self.model_of(states[0]))]
        done, each = 0, self.steps_per_state()
        free = int(round(fall.release / self.h)) if fall.held else -1
        for step in range(each, int(round(self.seconds / self.h)) + 1, each):
            if done <= free < step:
                if free > done:
                    self.step(free - done)
                for name in fall.held:
                    answer = self.let_go(body_name=name)
                    if not answer.success:
                        raise RuntimeError(answer.status_message)
                done = free
                models.append((self.get().state.time, self.model_of(self.get().state)))
            self.step(step - done)
            states.append(self.get().state)
            done = step
        return models, states

    def steps_per_state(self):
        """States are those of whole steps [s]: a rate that does not fit would be another one."""
        steps = 1 / (self.rate * self.h)
        each = max(1, int(round(steps)))
        if abs(steps - each) > 1e-3 * each:
            near = sorted({max(1, int(steps)), int(steps) + 1})
            sys.exit('fall_dataset: --rate %g does not fit steps of %g s: it can be %s Hz' % (
                self.rate, self.h, ' or '.join('%g' % (1 / (n * self.h)) for n in near)))
        return each

    def record(self, path, fall):
        """Writes the bag of a fall; returns all its labels."""
        models, states = self.simulate(fall)
        bodies = [state.ragdolls[0] for state in states]
        pushed = bool(fall.labels['push_body'])
        labels = dict(fall.labels, bag=os.path.basename(path), at_rest=bodies[-1].asleep,
                      push_begin=0.0 if pushed else '')
        labels.update({name: '' if value is None else value for name, value in fall.judge(
            [state.time for state in states], points(body.positions for body in bodies),
            points(body.velocities for body in bodies)).items()})
        first = models[0][1].run
        with rosbag.Bag(path, 'w') as bag:
            for time, model in models:
                self.write(bag, 'model', model, time, model.run - first, latching='1')
            self.write(bag, 'label', String(json.dumps(labels, sort_keys=True)), 0, 0, latching='1')
            for state in states:
                self.write(bag, 'state', state, state.time, state.run - first)
        return labels

    def write(self, bag, name, message, time, run, **header):
        """Stamps and run numbers are those of this fall, whatever the node did before."""
        stamp = rospy.Time.from_sec(EPOCH + time)
        if hasattr(message, 'header'):
            message.header.stamp, message.header.seq, message.run = stamp, 0, run
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
    parser.add_argument('--step', type=float, default=1 / 120, help='of the simulation [s]')
    parser.add_argument('--out', default='falls', help='folder for bags and labels.csv')
    parser.add_argument('--node', default='/ragdoll', help='name of the ragdoll_node')
    arguments = parser.parse_args(rospy.myargv()[1:])
    if arguments.falls < 1 or not 0 < arguments.seconds <= 3600 or not 0 < arguments.rate <= 10000:
        parser.error('--falls must be at least 1, --seconds in (0, 3600], --rate in (0, 10000]')
    if not 1e-5 <= arguments.step <= 0.1:
        parser.error('--step must be in [0.00001, 0.1]')
    return arguments


def main():
    arguments = read_arguments()
    table = os.path.join(arguments.out, 'labels.csv')
    if os.path.exists(table):
        sys.exit('fall_dataset: %s is there already: name another folder' % table)
    os.makedirs(arguments.out, exist_ok=True)
    rospy.init_node('fall_dataset')
    recorder = Recorder(arguments.node, arguments.seconds, arguments.rate, arguments.step)
    recorder.steps_per_state()  # before anything is written
    begin = rospy.get_rostime().to_sec()
    with open(table, 'w', newline='') as file:
        rows = csv.DictWriter(file, FIELDS)
        rows.writeheader()
        for i in range(arguments.falls):
            if rospy.is_shutdown():
                sys.exit(1)
            seed = arguments.seed + i
            labels = recorder.record(os.path.join(arguments.out, 'fall_%06d.bag' % seed),
                                     ragdoll.Fall(seed, step=arguments.step))
            rows.writerow(labels)
            file.flush()
            rospy.loginfo('%s: impact at %s s, %s', labels['bag'], labels['impact_time'],
                          labels['end_pose'])
    passed = rospy.get_rostime().to_sec() - begin
    rospy.loginfo('%d falls of %g s in %.1f s: %s', arguments.falls, arguments.seconds, passed, table)


if __name__ == '__main__':
    main()
