#!/usr/bin/python3
"""Bags of before Metrics had its present fields: rosbag plays them, and brings them up to date."""

import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

import genpy.dynamic
import rosbag
import roslib.packages
import rospy
import rostest
from client import LIMIT, wait_for
from ragdoll_msgs.msg import Metrics

TOPIC = '/ragdoll/metrics'
# md5sum of what was published, and the fields that came after it.
VERSIONS = [
    ('b7be4ce9395ae8f519a591d7c80f51c4', ['error_class', 'paused']),
    ('4ce02ef90a776c1bc83d293fe0108ab8', ['waiting', 'step_lateness_p50', 'step_lateness_p99',
                                          'step_lateness_p999', 'step_lateness_max']),
    ('448d3c21a74487497ab4e6c4ce7bde3a', ['guarded', 'implicit', 'rigid', 'joining', 'limited',
                                          'unresolved']),
    ('cba80e6e1e0f2773b1d74449572bfaa8', ['fast_fallbacks', 'tolerance_missed', 'error_estimate']),
]


def without(names):
    """The class of Metrics, as it was before it had these fields."""
    text = Metrics._full_text
    for name in names:
        text, found = re.subn(r'(?m)^\w+ %s\b.*\n' % name, '', text)
        assert found == 1, name
    return genpy.dynamic.generate_dynamic('ragdoll_msgs/Metrics', text)['ragdoll_msgs/Metrics']


class MigrationTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder)
        self.path = os.path.join(self.folder, 'old.bag')

    def old_bag(self, version):
        """Returns the message in it, each of whose fields has a value of its own."""
        later = [name for _, names in VERSIONS[version:] for name in names]
        message = without(later)()
        self.assertEqual(message._md5sum, VERSIONS[version][0])
        message.header.stamp = rospy.Time(7, 5)
        message.header.frame_id = 'map'
        for i, (name, kind) in enumerate(zip(message.__slots__[1:], message._slot_types[1:]), 1):
            value = {'string': 'text %d' % i, 'bool': True, 'uint32': i, 'float64': i / 8}[kind]
            setattr(message, name, value)
        with rosbag.Bag(self.path, 'w') as bag:
            for second in range(1, 4):
                bag.write(TOPIC, message, rospy.Time(second))
        return message

    def test_rosbag_brings_it_up_to_date(self):
        # Named, as rosbag finds them by itself only where rosdep has been set up.
        rule = os.path.join(roslib.packages.get_pkg_dir('ragdoll_sim'), 'migration', 'metrics.bmr')
        for version in range(len(VERSIONS)):
            old = self.old_bag(version)
            path = os.path.join(self.folder, 'new%d.bag' % version)
            fix = subprocess.run(['rosbag', 'fix', self.path, path, rule], stdout=subprocess.PIPE,
                                 stderr=subprocess.STDOUT, timeout=LIMIT, universal_newlines=True)
            self.assertEqual(fix.returncode, 0, fix.stdout)
            with rosbag.Bag(path) as bag:
                new = [m for _, m, _ in bag.read_messages()]
            self.assertEqual([m._md5sum for m in new], 3 * [Metrics._md5sum])
            expected = Metrics()
            for name in old.__slots__[1:]:
                setattr(expected, name, getattr(old, name))
            for name in Metrics.__slots__[1:]:
                self.assertEqual(getattr(new[0], name), getattr(expected, name), name)
            self.assertEqual((new[0].header.stamp, new[0].header.frame_id),
                             (rospy.Time(7, 5), 'map'))

    def test_the_package_tells_rosbag_of_its_rules(self):
        folder = roslib.packages.get_pkg_dir('ragdoll_sim')
        with open(os.path.join(folder, 'package.xml')) as f:
            named = re.findall('migration_rule_file="([^"]*)"', f.read())
        there = os.listdir(os.path.join(folder, 'migration'))
        self.assertEqual(sorted(named), sorted('migration/' + name for name in there))

    def test_it_plays_as_it_is(self):
        old = self.old_bag(0)
        heard = []
        subscriber = rospy.Subscriber(TOPIC, type(old), heard.append, queue_size=None)
        self.addCleanup(subscriber.unregister)
        play = subprocess.Popen(['rosbag', 'play', '--quiet', '--wait-for-subscribers', self.path],
                                stdout=subprocess.DEVNULL)
        self.addCleanup(play.wait)
        wait_for(lambda: len(heard) == 3, 'three messages of before')
        self.assertEqual(heard[0].realtime_factor, old.realtime_factor)


if __name__ == '__main__':
    rospy.init_node('migration_test')
    rostest.rosrun('ragdoll_sim', 'migration', MigrationTest, sys.argv)
