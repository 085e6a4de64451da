#!/usr/bin/python3
"""A wrong parameter ends the node at once, with a message that names it."""

import subprocess
import sys
import unittest

import roslib.packages
import rospy
import rostest
from client import LIMIT

CASES = [
    ('publish_rate', '0', ['[0.001, 1000]']),
    ('publish_rate', 'often', ['often', 'number']),
    ('publish_rate', '-60.0', ['[0.001, 1000]']),
    ('realtime_factor', '-2', ['-1', '> 0']),
    ('realtime_factor', '0', ['-1', '> 0']),
    ('start_paused', 'perhaps', ['perhaps', 'true or false']),
    ('show_limits', 'perhaps', ['perhaps', 'true or false']),
    ('world_frame', '/', ['frame']),
    ('wrench_timeout', '0', ['(0, 60]']),
    ('coat', 'fur', ['fur', 'capsules']),
    ('scene', 'nowhere', ['nowhere', 'stairs']),
    ('scene', '/nowhere/at_all.yaml', ['/nowhere/at_all.yaml']),
    ('scene', 'package://no_such_package/x.yaml', ['no_such_package']),
]


class ParametersTest(unittest.TestCase):
    def test_a_wrong_parameter_is_named(self):
        program = roslib.packages.find_node('ragdoll_sim', 'ragdoll_node')[0]
        for i, (name, value, words) in enumerate(CASES):
            run = subprocess.run(
                [program, '__name:=wrong_%d' % i, '_%s:=%s' % (name, value)], timeout=LIMIT,
                stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True)
            self.assertEqual(run.returncode, 1, run.stdout)
            for word in ['/wrong_%d/%s' % (i, name)] + words:
                self.assertIn(word, run.stdout)


if __name__ == '__main__':
    rospy.init_node('parameters_test')
    rostest.rosrun('ragdoll_sim', 'parameters', ParametersTest, sys.argv)
