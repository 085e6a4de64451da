#!/usr/bin/python3
"""The first commands of each page for a kind of user run as they stand and give what the page says."""

import csv
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest

import roslib.packages
import rospy
import rosservice
import rostest
from client import LIMIT, Inbox, wait_for
from geometry_msgs.msg import WrenchStamped
from page import of_node

DOCS = os.path.join(roslib.packages.get_pkg_dir('ragdoll'), 'docs')
DEVEL = os.environ['CMAKE_PREFIX_PATH'].split(':')[0]
LONG = 4 * LIMIT  # [s] for what computes as fast as it can


def text_of(page):
    with open(os.path.join(DOCS, page)) as file:
        return file.read()


class PagesTest(unittest.TestCase):
    def setUp(self):
        """A folder in which build/devel is what a user has built."""
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder)
        os.mkdir(os.path.join(self.folder, 'build'))
        os.symlink(DEVEL, os.path.join(self.folder, 'build', 'devel'))

    def start(self, page):
        """A shell with the page's first block of commands, in a group of its own."""
        commands = re.search(r'```\n(.*?)```', text_of(page), re.DOTALL).group(1)
        self.out, self.err = (open(os.path.join(self.folder, name), 'w+')
                              for name in ('stdout', 'stderr'))
        self.addCleanup(self.out.close)
        self.addCleanup(self.err.close)
        shell = subprocess.Popen(['bash', '-ec', commands], cwd=self.folder, start_new_session=True,
                                 env=dict(os.environ, PWD=self.folder), stdin=subprocess.DEVNULL,
                                 stdout=self.out, stderr=self.err)
        self.addCleanup(self.end, shell)
        return shell

    def said(self, file):
        file.seek(0)
        return file.read()

    def run_page(self, page):
        """What it printed, once its commands are done."""
        status = self.start(page).wait(LONG)
        self.assertEqual(status, 0, self.said(self.err))
        return self.said(self.out)

    def end(self, shell):
        """With what it started in the background, which does not hear of Ctrl-C; returns when all are gone."""
        def gone():
            shell.poll()
            try:
                os.killpg(shell.pid, 0)
            except ProcessLookupError:
                return True
            return False
        if not gone():
            os.killpg(shell.pid, signal.SIGTERM)
            try:
                wait_for(gone, 'the end of what a page started')
            except AssertionError:
                os.killpg(shell.pid, signal.SIGKILL)
                raise

    def path(self, *names):
        return os.path.join(self.folder, *names)

    def test_robot(self):
        self.start('robot.md')
        told = set(re.findall(r'^\| `(/ragdoll/[a-z_/]+)`', text_of('robot.md'), re.MULTILINE))
        self.assertGreater(len(told), 2)
        told.remove('/ragdoll/wrenches/palm')  # of the page's own scene
        wait_for(lambda: told <= of_node('/ragdoll')[0], 'the topics of the page')
        wait_for(lambda: {'/ragdoll/attach', '/ragdoll/detach'} <=
                 set(rosservice.get_service_list('/ragdoll')), 'the services of the page')
        force = Inbox('/ragdoll/wrenches/attach_right_hand', WrenchStamped)
        force.first(lambda m: m.wrench.force.x < -30, 'the force of a body that is dragged')

    def test_the_scene_of_a_robot(self):
        """The page's YAML, without the robot: the body lies on its back."""
        scene = self.path('casualty.yaml')
        with open(scene, 'w') as file:
            file.write(re.search(r'```yaml\n(.*?)```', text_of('robot.md'), re.DOTALL).group(1))
        lab = roslib.packages.find_node('ragdoll_sim', 'ragdoll_lab')[0]
        run = subprocess.run([lab, 'run', scene, '--seconds', '5', '--summary'], timeout=LIMIT,
                             stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True)
        self.assertEqual(run.returncode, 0, run.stderr)
        summary = json.loads(run.stdout)
        self.assertEqual(summary['asleep'], 1)
        self.assertLess(summary['max_penetration'], 1e-3)

    def test_node(self):
        printed = self.run_page('node.md')
        self.assertIn('ragdoll/head: (100, 0, 0) N', printed)
        self.assertIn('first particle at', printed)

    def test_data(self):
        printed = self.run_page('data.md')
        self.assertTrue(os.path.getsize(self.path('sample.h5')) > 1e6)
        with open(self.path('sample', 'labels.csv'), newline='') as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([int(row['seed']) for row in rows], list(range(1, 21)))
        self.assertIn('impact_time', printed)
        for row in rows:
            self.assertTrue(os.path.exists(self.path('sample', row['bag'] + '.csv')), row['bag'])

    def test_trade(self):
        printed = self.run_page('trade.md')
        summary, end = json.JSONDecoder().raw_decode(printed)
        self.assertLess(summary['max_stick_error'], 1e-9)
        self.assertIn('balanced = shake', printed[end:])
        for name in ('trade.csv', 'trade.png'):
            self.assertGreater(os.path.getsize(self.path('out', name)), 0, name)

    def test_own_body(self):
        self.assertAlmostEqual(json.loads(self.run_page('own_body.md'))['seconds'], 3, delta=0.01)


if __name__ == '__main__':
    rospy.init_node('pages_test')
    rostest.rosrun('ragdoll_sim', 'pages', PagesTest, sys.argv)
