#!/usr/bin/python3
"""~load_scene, ~get_state and ~set_state."""

import sys
import threading
import unittest

import rospy
import rostest
import yaml
from client import LIMIT, Client, Inbox, bits, wait_for
from dynamic_reconfigure.client import Client as Settings
from ragdoll_msgs.srv import SetState
from rosgraph_msgs.msg import Log

YAML = '''
gravity: [0, 0, 0]
ragdolls:
  - {name: anna, model: human, position: [0, 0, 3]}
  - {name: ben, model: human, position: [2, 0, 3]}
'''


class ScenesTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.client = Client()
        cls.log = Inbox('/rosout', Log)
        cls.call_set = cls.client.service('set_state', SetState)

    def setUp(self):
        self.client.load(path='fall')
        self.client.restart()

    def names(self):
        return [r.name for r in self.client.states.all()[-1].ragdolls]

    def test_loads_by_name_package_or_text(self):
        self.client.load(path='package://ragdoll_sim/scenes/two.yaml')
        wait_for(lambda: self.names() == ['anna', 'ben'], 'the states of two')
        self.client.load(yaml=YAML)
        self.assertEqual([r.name for r in self.client.model.ragdolls], ['anna', 'ben'])
        before = self.client.at(0)
        after = self.client.step(100)  # pause survives
        self.assertEqual(before.ragdolls[1].positions[0].z, after.ragdolls[1].positions[0].z)

    def test_a_model_loads_as_the_scene_that_it_is_of(self):
        self.client.load(path='stairs')
        expected = bits(self.client.step(50))
        self.client.load(yaml=self.client.model.scene_yaml)
        self.assertEqual(bits(self.client.step(50)), expected)

    def test_the_log_says_what_the_checks_found(self):
        def said(level, *words):
            return [m for m in self.log.all()
                    if m.level == level and all(word in m.msg for word in words)]

        self.client.load(yaml=YAML + 'self_collision: true')
        wait_for(lambda: said(Log.INFO, "self collision of 'human'", '76 that share a particle',
                              '23 that overlap in the rest pose', 'ragdoll_lab run SCENE --pairs'),
                 'the pairs left out')
        pairs = len(said(Log.INFO, "self collision of 'human'"))
        for line in said(Log.INFO, "self collision of 'human'"):
            self.assertLess(len(line.msg), 250)  # not the names of pairs
        self.assertEqual(self.client.load(yaml=YAML + 'self_collision: true').status_message,
                         '2 ragdolls, 0 obstacles')
        self.assertEqual(self.client.load(path='fall').status_message, '1 ragdoll, 1 obstacle')
        doll = YAML.replace('{name: anna, model: human, position: [0, 0, 3]}', """
      name: anna
      model:
        particles: {a: {position: [0, 0, 0], mass: 1}, b: {position: [0, 0, 1], mass: 1}}
        sticks: [[a, b, 1.5]]""")
        answer = self.client.load(yaml=doll)
        self.assertIn('b by 250 mm', answer.status_message)
        wait_for(lambda: said(Log.WARN, 'b by 250 mm'), 'the warning')
        self.assertEqual(len(said(Log.INFO, "self collision of 'human'")), pairs)  # not told twice

    def test_an_error_leaves_the_old_scene_untouched(self):
        cases = [
            ({}, ['neither', 'exactly one']),
            ({'path': 'fall', 'yaml': YAML}, ['both', 'exactly one']),
            ({'path': '/nowhere/at_all.yaml'}, ['/nowhere/at_all.yaml']),
            ({'path': 'nowhere'}, ['nowhere', 'stairs']),
            ({'path': 'nowhere.yaml'}, ['nowhere.yaml', 'no such file in /', 'stairs']),
            ({'path': 'package://no_such_package/a.yaml'}, ['no_such_package']),
            ({'yaml': 'ragdolls: ['}, ['yaml']),
            ({'yaml': 'ragdolls:\n  - {name: a, model: human, colour: red}'}, ['2', 'colour']),
            ({'yaml': 'ragdolls:\n  - {name: a, model: giant}'}, ['giant', 'human']),
            ({'yaml': YAML + 'gravity: [0, 0, .nan]'}, ['gravity']),
            ({'yaml': YAML + 'obstacles: [{type: sphere, position: [0, 0, 0], radius: 1, frame: /ben/head}]'},
             ['yaml:6: obstacles[0]: frame', '/ben/head', "another node's"]),
            ({'yaml': YAML + 'pins: [{particle: anna/head, frame: ben/pelvis}]'},
             ['yaml:6: pins[0]: frame', 'ben/pelvis', "another node's"]),
        ]
        expected = bits(self.client.step(60))
        self.client.restart()
        self.client.step(30)
        for scene, words in cases:
            answer = self.client.call_load(**scene)
            self.assertFalse(answer.success, scene)
            for word in words:
                self.assertIn(word, answer.status_message)
        self.assertEqual(bits(self.client.step(30)), expected)

    def test_a_snapshot_goes_on_to_the_same_bits(self):
        self.client.step(40)
        self.client.poke('head', (40, 10, 0), duration=0.5)
        self.client.poke('left_foot', (0, 0, 30), duration=-1)
        self.client.step(20)
        kept = self.client.call_get()
        self.assertEqual(kept.state.step, 60)
        self.assertEqual(bits(kept.state), bits(self.client.at(60)))
        expected = bits(self.client.step(200))
        self.client.restart()
        self.client.step(7)
        answer = self.call_set(kept.snapshot)
        self.assertTrue(answer.success, answer.status_message)
        self.assertEqual(bits(self.client.at(60)), bits(kept.state))
        self.assertEqual(bits(self.client.step(200)), expected)
        # It also fits the same scene loaded anew.
        self.client.load(path='fall')
        self.assertTrue(self.call_set(kept.snapshot).success)
        self.assertEqual(bits(self.client.step(200)), expected)

    def test_settings_during_a_load_are_of_one_of_the_two_scenes(self):
        settings = Settings('/ragdoll', timeout=LIMIT)
        self.client.call_pause(False)
        seen, stop = len(self.client.models.all()), threading.Event()
        sent = []

        def turn_gravity():
            while not stop.is_set():
                sent.append(len(sent) % 7 - 3.5)
                settings.update_configuration({'gravity_x': sent[-1]})
        thread = threading.Thread(target=turn_gravity)
        thread.start()
        try:
            for i in range(100):
                answer = self.client.call_load(**({'yaml': YAML} if i % 2 else {'path': 'fall'}))
                self.assertTrue(answer.success, answer.status_message)
            after = len(sent)
            wait_for(lambda: len(sent) > after + 1, 'the last setting')
        finally:
            stop.set()
            thread.join()
        down = {('anna', 'ben'): 0.0, ('ragdoll',): -9.81}
        for model in self.client.models.all()[seen:]:
            names = tuple(r.name for r in model.ragdolls)
            scene = yaml.safe_load(model.scene_yaml)
            self.assertEqual(len(scene['ragdolls']), len(names))
            self.assertEqual(scene['gravity'][2], down[names])  # nobody has asked for another
        state = self.client.call_get().state
        self.assertEqual([r.name for r in state.ragdolls], ['anna', 'ben'])
        shown = settings.get_configuration(timeout=LIMIT)
        self.assertEqual((shown['gravity_x'], shown['gravity_z']), (sent[-1], 0.0))

    def test_what_is_no_snapshot_of_this_scene_is_refused(self):
        kept = self.client.call_get().snapshot
        damaged = kept[:100] + bytes([kept[100] ^ 4]) + kept[101:]
        self.client.step(10)
        cases = [(b'', 'get_state'), (b'nonsense' * 20, 'get_state'), (damaged, 'damaged'),
                 (kept[:-1], 'damaged'), (kept + b'x', 'damaged')]
        for snapshot, word in cases:
            answer = self.call_set(snapshot)
            self.assertFalse(answer.success)
            self.assertIn(word, answer.status_message)
        self.assertEqual(self.client.call_get().state.step, 10)
        self.client.load(path='stairs')
        answer = self.call_set(kept)
        self.assertFalse(answer.success)
        self.assertIn('another scene', answer.status_message)


if __name__ == '__main__':
    rospy.init_node('scenes_test')
    rostest.rosrun('ragdoll_sim', 'scenes', ScenesTest, sys.argv)
