#!/usr/bin/python3
"""rosbag records ~state, ~model and /tf, and plays back what was heard."""

import os
import shutil
import subprocess
import sys
import tempfile
import unittest

import rosbag
import roslib.packages
import rospy
import rostest
from bags import Recorder, serialized
from client import Client, Inbox, bits, wait_for
from ragdoll_msgs.msg import State
from tf2_msgs.msg import TFMessage

TOPICS = ['/ragdoll/state', '/ragdoll/model', '/tf']
MESSAGES = 90


class BagTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.path = os.path.join(self.folder, 'run.bag')
        self.addCleanup(shutil.rmtree, self.folder)

    def record(self, client):
        recorder = Recorder(self.path, client.node, TOPICS)
        client.restart()  # its state is published once, whatever the time
        client.call_pause(False)
        seen = len(client.states.all())
        wait_for(lambda: len(client.states.all()) > seen + MESSAGES, 'states to record')
        recorder.stop()
        with rosbag.Bag(self.path) as bag:
            return [(topic, message) for topic, message, _ in bag.read_messages()]

    def test_a_bag_holds_what_was_published_and_plays_it(self):
        client = Client()
        heard_tf = Inbox('/tf', TFMessage)
        recorded = self.record(client)
        states = [m for topic, m in recorded if topic == '/ragdoll/state']
        transforms = [m for topic, m in recorded if topic == '/tf']
        models = [m for topic, m in recorded if topic == '/ragdoll/model']

        # Every recorded state is one that was heard, and none is missing between first and last.
        self.assertGreaterEqual(len(states), MESSAGES // 2)
        wait_for(lambda: client.states.all()[-1].header.stamp >= states[-1].header.stamp, 'states')
        heard = {m.header.stamp: m for m in client.states.all()}
        for state in states:
            self.assertEqual(bits(state), bits(heard[state.header.stamp]))
        between = [s for s in sorted(heard) if states[0].header.stamp <= s <= states[-1].header.stamp]
        self.assertEqual([s.header.stamp for s in states], between)
        self.assertIn(0, [s.step for s in states])  # the reset

        # The bag explains itself.
        self.assertEqual(len(models), 1)
        self.assertEqual(len(models[0].ragdolls[0].particles), len(states[0].ragdolls[0].positions))
        self.assertIn('ragdolls:', models[0].scene_yaml)

        # Transforms for each state, all frames in each, none with the stamp of another.
        stamps = [m.transforms[0].header.stamp for m in transforms]
        self.assertEqual(len(set(stamps)), len(stamps))
        self.assertEqual({len(m.transforms) for m in transforms}, {17})
        of_states = {s.header.stamp for s in states if stamps[0] <= s.header.stamp <= stamps[-1]}
        self.assertGreaterEqual(len(of_states), MESSAGES // 2)
        self.assertLessEqual(of_states, set(stamps))
        heard_tf.first(lambda m: m.transforms[0].header.stamp >= stamps[-1], 'the last transforms')
        self.assertLessEqual(set(stamps), {m.transforms[0].header.stamp for m in heard_tf.all()})

        self.play(states, transforms)

    def play(self, states, transforms):
        program = roslib.packages.find_node('rosbag', 'play')[0]
        player = subprocess.Popen(
            [program, '--quiet', '--wait-for-subscribers', self.path,
             '/ragdoll/state:=/played/state', '/tf:=/played/tf', '/ragdoll/model:=/played/model',
             '--topics'] + ['/ragdoll/state', '/tf'], stdout=subprocess.DEVNULL)
        self.addCleanup(player.kill)
        played_states, played_tf = Inbox('/played/state', State), Inbox('/played/tf', TFMessage)
        wait_for(lambda: len(played_states.all()) >= len(states), 'all states')
        wait_for(lambda: len(played_tf.all()) >= len(transforms), 'all transforms')
        self.assertEqual([bits(m) for m in played_states.all()], [bits(m) for m in states])
        self.assertEqual([serialized(m) for m in played_tf.all()],
                         [serialized(m) for m in transforms])


if __name__ == '__main__':
    rospy.init_node('bag_test')
    rostest.rosrun('ragdoll_sim', 'bag', BagTest, sys.argv)
