#!/usr/bin/python3
"""rviz's configurations, with ragdoll_rviz and where it is not built; slips at the start."""

import glob
import os
import subprocess
import sys
import tempfile
import unittest

import rospkg
import rostest
import yaml

FOLDER = os.path.join(rospkg.RosPack().get_path('ragdoll'), 'rviz')
OURS = 'ragdoll_rviz/'


def without_ours(node):
    """A copy of the YAML without the items of ragdoll_rviz's classes; bodies are markers then."""
    if isinstance(node, dict):
        return {key: without_ours(value) for key, value in node.items()}
    if isinstance(node, list):
        return [without_ours(item) for item in node
                if not (isinstance(item, dict) and item.get('Class', '').startswith(OURS))]
    return '/ragdoll/markers' if node == '/ragdoll/scenery' else node


class ViewTest(unittest.TestCase):
    def started_with(self, config, built):
        """What rviz is started with, beside the text of its configuration."""
        with tempfile.TemporaryDirectory() as folder:
            rospack = os.path.join(folder, 'rospack')
            with open(rospack, 'w') as f:
                f.write('#!/bin/sh\nexit %d\n' % (0 if built else 1))
            os.chmod(rospack, 0o755)
            path = folder + ':' + os.environ['PATH']
            out = subprocess.run(
                ['sh', os.path.join(FOLDER, 'with_plugins.sh'), 'printf', '%s\n', '-d', config,
                 'a b', '__name:=rviz'],
                env=dict(os.environ, PATH=path, TMPDIR=folder), check=True,
                stdout=subprocess.PIPE, universal_newlines=True).stdout.splitlines()
            self.assertEqual([out[0]] + out[2:], ['-d', 'a b', '__name:=rviz'])
            with open(out[1]) as f:
                return out[1], f.read()

    def test_all_views(self):
        views = glob.glob(os.path.join(FOLDER, '*.rviz'))
        self.assertGreaterEqual(len(views), 2)
        for view in views:
            with open(view) as f:
                text = f.read()
            self.assertEqual(text.count('Class: ' + OURS), 3, view)  # panel, tool and display
            self.assertIn('/ragdoll/scenery', text)
            self.assertEqual(self.started_with(view, built=True), (view, text))
            other = self.started_with(view, built=False)[1]
            self.assertEqual(yaml.safe_load(other), without_ours(yaml.safe_load(text)), view)
            self.assertNotIn(OURS, other)

    def test_a_view_that_is_not_there(self):
        run = subprocess.run(['sh', os.path.join(FOLDER, 'with_plugins.sh'), 'true', '-d',
                              os.path.join(FOLDER, 'closer.rviz')],
                             stderr=subprocess.PIPE, universal_newlines=True)
        self.assertEqual(run.returncode, 2)
        self.assertIn('closer.rviz; there are crowd ragdoll rescue tall', run.stderr)

    def test_an_argument_that_is_not_there(self):
        run = subprocess.run([os.path.join(FOLDER, '..', 'run'), '--setup', 'scen:=fall'],
                             stderr=subprocess.PIPE, universal_newlines=True)
        self.assertEqual(run.returncode, 1)
        self.assertIn("no argument 'scen'; there are scene rviz view", run.stderr)


if __name__ == '__main__':
    rostest.rosrun('ragdoll_sim', 'view', ViewTest, sys.argv)
