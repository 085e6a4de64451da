#!/usr/bin/python3
"""/diagnostics: warns while the simulation is slower than wanted, and says what it does."""

import sys
import unittest

import rospy
import rostest
from client import Client, Inbox
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus


class DiagnosticsTest(unittest.TestCase):
    def test_slower_than_wanted_is_a_warning_and_paused_is_none(self):
        client = Client()
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
