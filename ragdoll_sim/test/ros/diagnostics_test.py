#!/usr/bin/python3
"""/diagnostics: warns of what is slower than wanted or beyond the solver, and says what it does."""

import sys
import unittest

import rospy
import rostest
from client import Client, Inbox
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus

# A ball between two parts of the chest, which is rigid.
NO_ROOM = """
ragdolls: [{name: ragdoll, model: human, position: [0, 0, 0.98]}]
obstacles:
  - {type: plane}
  - {type: sphere, position: [0.02, 0, 1.2], radius: 0.15}
"""
TOO_MUCH = """
gravity: [0, 0, 0]
ragdolls: [{name: ragdoll, model: human, position: [0, 0, 0]}]
pokes: [{at: 0.1, body: right_hand, force: [0, 1e10, 0]}]
"""
TOO_FAR = """
gravity: [0, 0, 0]
ragdolls: [{name: ragdoll, model: human, position: [0, 0, 0], velocity: [1e10, 0, 0]}]
"""


class DiagnosticsTest(unittest.TestCase):
    def test_beyond_the_solver_is_a_warning_that_says_what_to_look_for(self):
        client = Client()
        reports = Inbox('/diagnostics', DiagnosticArray)
        for scene, hint in ((NO_ROOM, 'leave a body no room'), (TOO_MUCH, 'look for huge forces'),
                            (TOO_FAR, 'too coarse for a body: ragdoll; ~reset')):
            client.load(yaml=scene)
            told = reports.first(lambda m: hint in m.status[0].message, hint)
            self.assertEqual(told.status[0].level, DiagnosticStatus.WARN)

    def test_slower_than_wanted_is_a_warning_and_paused_is_none(self):
        client = Client()
        client.load(path='crowd')
        reports = Inbox('/diagnostics', DiagnosticArray)
        late = reports.first(lambda m: m.status[0].level == DiagnosticStatus.WARN, 'a warning')
        self.assertIn('slower than real time', late.status[0].message)
        self.assertEqual(late.status[0].name, 'ragdoll: simulation')
        values = {v.key: v.value for v in late.status[0].values}
        self.assertEqual(values['ragdolls'], '20')
        self.assertIn('step', values['solver'])
        self.assertGreater(float(values['real-time factor']), 0)
        self.assertTrue(client.call_pause(True).success)
        reports.first(lambda m: m.header.stamp > late.header.stamp and m.status[0].level ==
                      DiagnosticStatus.OK and m.status[0].message == 'paused', 'a pause')


if __name__ == '__main__':
    rospy.init_node('diagnostics_test')
    rostest.rosrun('ragdoll_sim', 'diagnostics', DiagnosticsTest, sys.argv)
