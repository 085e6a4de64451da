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
from client import LIMIT, Client, wait_for
from ragdoll_msgs.srv import Detach

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

    def test_lets_go_when_the_force_exceeds(self):
        """A body hangs by its hand: 75 kg are more than 150 N."""
        client = Client()
        client.load(path='hang')
        run = subprocess.run([sys.executable, os.path.join(EXAMPLES, 'stop_at_force.py'), '150',
                              'pin_right_hand'], timeout=2 * LIMIT, stdout=subprocess.PIPE,
                             stderr=subprocess.STDOUT, universal_newlines=True)
        self.assertEqual(run.returncode, 0, run.stdout)
        self.assertGreater(float(run.stdout.split(' N: ')[0].split()[-1]), 150)
        self.assertFalse(client.service('detach', Detach)('right_hand').success, 'it hangs still')
        client.load(path='weightless')

    def test_the_page_shows_these_files(self):
        page = text_of(os.path.join(DOCS, 'node.md'))
        blocks = dict(re.findall(r'```(python|cpp)\n(.*?)```', page, re.DOTALL))
        self.assertEqual(blocks['python'], text_of(os.path.join(EXAMPLES, 'poke.py')))
        self.assertEqual(blocks['cpp'], text_of(os.path.join(EXAMPLES, 'poke.cpp')))


if __name__ == '__main__':
    rospy.init_node('examples_test')
    rostest.rosrun('ragdoll_sim', 'examples', ExamplesTest, sys.argv)
