#!/usr/bin/python3
"""The examples of the pages are the files in examples/, and do what they say."""

import os
import re
import subprocess
import sys
import unittest

import roslib.packages
import rospy
import rostest
import tf2_ros
from client import LIMIT, Client, wait_for
from geometry_msgs.msg import TransformStamped, WrenchStamped
from ragdoll_msgs.srv import Attach, Detach

EXAMPLES = os.path.join(roslib.packages.get_pkg_dir('ragdoll_sim'), 'examples')
DOCS = os.path.join(roslib.packages.get_pkg_dir('ragdoll'), 'docs')


def text_of(path):
    with open(path) as file:
        return file.read()


class ExamplesTest(unittest.TestCase):
    def assert_pokes(self, command):
        client = Client()
        seen = len(client.pokes.all())
        run = subprocess.run(command, timeout=2 * LIMIT, stdout=subprocess.PIPE,
                             stderr=subprocess.STDOUT, universal_newlines=True)
        self.assertEqual(run.returncode, 0, run.stdout)
        self.assertIn('ragdoll/head: (100, 0, 0) N', run.stdout)
        event = wait_for(lambda: client.pokes.all()[seen:], 'the poke')[0]
        self.assertEqual((event.body_name, event.force.x), ('ragdoll/head', 100))
        self.assertAlmostEqual(event.duration.to_sec(), 0.2, delta=0.01)

    def test_python(self):
        self.assert_pokes([sys.executable, os.path.join(EXAMPLES, 'poke.py')])

    def test_cpp(self):
        self.assert_pokes([roslib.packages.find_node('ragdoll_sim', 'poke_example')[0]])

    def guard(self, *arguments):
        """stop_at_force.py, and what it says by its end."""
        program = os.path.join(EXAMPLES, 'stop_at_force.py')
        guard = subprocess.Popen([sys.executable, program] + list(arguments), stdout=subprocess.PIPE,
                                 stderr=subprocess.STDOUT, universal_newlines=True)
        self.addCleanup(lambda: guard.poll() is None and guard.kill())
        return guard, lambda: guard.communicate(timeout=2 * LIMIT)[0]

    def assert_lets_go(self, body, limit, holder):
        guard, said = self.guard(str(limit), holder)
        told = said()
        self.assertEqual(guard.returncode, 0, told)
        self.assertGreater(float(told.split(' N: ')[0].split()[-1]), limit)
        self.assertIn(body + ' is free', told)

    def test_lets_go_when_the_force_exceeds(self):
        """A body hangs by its hand: 75 kg are more than 150 N."""
        client = Client()
        client.load(path='hang')
        self.assert_lets_go('ragdoll/right_hand', 150, 'pin_right_hand')
        self.assertFalse(client.service('detach', Detach)('right_hand').success, 'it hangs still')
        client.load(path='weightless')

    def test_lets_go_of_any_ragdoll(self):
        client = Client()
        client.load(path='two')
        gripper = TransformStamped()
        gripper.header.frame_id, gripper.child_frame_id = 'world', 'gripper'
        gripper.transform.translation.z = 3
        gripper.transform.rotation.w = 1
        frames = tf2_ros.StaticTransformBroadcaster()
        frames.sendTransform(gripper)
        attach = client.service('attach', Attach)
        wait_for(lambda: attach('ben/right_hand', 'gripper').success, 'a hand that is held')
        self.assert_lets_go('ben/right_hand', 50, 'attach_ben_right_hand')
        self.assertFalse(client.service('detach', Detach)('ben/right_hand').success, 'it is held still')
        client.load(path='weightless')

    def test_feels_each_force_and_tells_what_was_refused(self):
        """One among many, of what nobody holds."""
        Client()
        guard, said = self.guard('50', 'attach_right_hand')
        tell = rospy.Publisher('/ragdoll/wrenches/attach_right_hand', WrenchStamped, queue_size=100)
        wait_for(lambda: tell.get_num_connections() > 0, 'the guard')
        for force in 20 * [1] + [1000] + 20 * [1]:
            message = WrenchStamped()
            message.wrench.force.x = force
            tell.publish(message)
        told = said()
        self.assertEqual(guard.returncode, 1, told)
        self.assertIn('1000 N: ', told)
        self.assertIn("'ragdoll/right_hand' is not held", told.splitlines()[-1])

    def test_guards_nothing_without_a_limit_and_a_holder_that_there_can_be(self):
        Client()
        for arguments, reason in ((('nan',), 'it must be > 0 N'), (('0',), 'it must be > 0 N'),
                                  (('50', 'attach_tail'), "unknown holder 'attach_tail'")):
            guard, said = self.guard(*arguments)
            told = said()
            self.assertEqual(guard.returncode, 1, told)
            self.assertIn(reason, told)

    def test_the_page_shows_these_files(self):
        page = text_of(os.path.join(DOCS, 'node.md'))
        blocks = dict(re.findall(r'```(python|cpp)\n(.*?)```', page, re.DOTALL))
        self.assertEqual(blocks['python'], text_of(os.path.join(EXAMPLES, 'poke.py')))
        self.assertEqual(blocks['cpp'], text_of(os.path.join(EXAMPLES, 'poke.cpp')))


if __name__ == '__main__':
    rospy.init_node('examples_test')
    rostest.rosrun('ragdoll_sim', 'examples', ExamplesTest, sys.argv)
