#!/usr/bin/python3
"""An installed package has its programs where rosrun looks, and each can be run."""

import os
import pathlib
import subprocess
import tempfile
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
SCRIPT = pathlib.Path(os.environ['RAGDOLL_BUILD']) / 'cmake_install.cmake'


class Install(unittest.TestCase):
    def test_programs_are_executable(self):
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run(['cmake', '-P', str(SCRIPT)], env=dict(os.environ, DESTDIR=folder),
                           check=True, stdout=subprocess.DEVNULL)
            places = list(pathlib.Path(folder).glob('**/lib/ragdoll_sim'))
            self.assertEqual(len(places), 1)
            names = ['poke.py', 'stop_at_force.py', 'push.py', 'rescue.py', 'ragdoll_lab', 'ragdoll_node']
            for name in names:
                self.assertTrue(os.access(places[0] / name, os.X_OK), name)
            for scene in SOURCE.glob('scenes/*.yaml'):
                self.assertEqual(len(list(pathlib.Path(folder).glob('**/scenes/' + scene.name))), 1, scene)


if __name__ == '__main__':
    unittest.main()
