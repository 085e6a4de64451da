#!/usr/bin/python3
"""/diagnostics: warns of what is slower than wanted or beyond the solver, and says what it does."""

import sys
import unittest

import rospy
import rostest
from client import Client, Inbox
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from ragdoll_msgs.msg import Metrics

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
# Across a box, and asleep there.
ACROSS = """
ragdolls: [{name: anna, model: human, position: [0, 0, 0.16], rpy_deg: [0, 90, 0]}]
obstacles:
  - {type: plane}
  - {type: box, position: [0.7, 0, 0.1], size: [0.1, 2, 0.2]}
"""
LYING = """
ragdolls: [{name: anna, model: human, position: [0, 0, 0.16], rpy_deg: [0, 90, 0]}]
obstacles: [{type: plane}]
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

    def test_what_stands_in_each_other_is_a_warning_at_load_and_while_it_lasts(self):
        client = Client()
        client.call_pause(True)
        reports = Inbox('/diagnostics', DiagnosticArray)
        answer = client.load(yaml=ACROSS)
        self.assertRegex(answer.status_message, 'anna is [0-9]+ cm inside box_1 at the start')
        told = reports.first(lambda m: 'inside box_1' in m.status[0].message, 'a warning')
        self.assertEqual(told.status[0].level, DiagnosticStatus.WARN)
        client.load(yaml=LYING)
        reports.first(lambda m: m.header.stamp > told.header.stamp and
                      'inside' not in m.status[0].message, 'its end')
        client.call_pause(False)

    def test_a_body_asleep_still_touches_what_carries_it(self):
        client = Client()
        client.load(yaml=LYING)
        client.call_pause(False)
        metrics = Inbox('/ragdoll/metrics', Metrics)
        asleep = metrics.first(lambda m: m.asleep == 1, 'a body asleep')
        self.assertGreater(asleep.contacts, 3)

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
