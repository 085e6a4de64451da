#!/usr/bin/python3
"""~metrics, ~joint_states, ~markers and dynamic_reconfigure."""

import sys
import unittest

import rospy
import rostest
import yaml
from client import LIMIT, Client, Inbox, position, wait_for
from dynamic_reconfigure.client import Client as Settings
from ragdoll_msgs.msg import Metrics, Model
from sensor_msgs.msg import JointState
from visualization_msgs.msg import Marker, MarkerArray


class TelemetryTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.client = Client()
        cls.settings = Settings('/ragdoll', timeout=LIMIT)

    def setUp(self):
        self.client.load(path='fall')
        self.client.restart()

    def test_metrics_of_a_fall(self):
        metrics = Inbox('/ragdoll/metrics', Metrics)
        standing = metrics.first(lambda m: m.realtime_factor == 0 and m.contacts == 0, 'a pause')
        self.assertTrue(standing.paused)
        self.client.call_pause(False)
        running = metrics.first(lambda m: not m.paused and abs(m.realtime_factor - 1) < 0.05 and
                                1e-7 < m.step_time < 1e-2, 'real time')
        self.assertEqual(running.ragdolls, 1)
        lying = metrics.first(lambda m: m.contacts > 3 or m.asleep == 1, 'contacts')
        self.assertLess(lying.potential_energy, standing.potential_energy - 300)
        self.assertLess(lying.max_stick_error, 0.05)
        self.assertLess(lying.max_penetration, 0.02)
        self.assertIn('step', lying.solver)

    def test_metrics_tell_what_the_step_guard_did(self):
        metrics = Inbox('/ragdoll/metrics', Metrics)
        refused = self.client.poke('right_hand', (0, 0, 1e300))
        self.assertFalse(refused.success)
        self.assertIn('at most', refused.status_message)
        quiet = metrics.first(lambda m: m.paused and m.realtime_factor == 0, 'a pause')
        self.assertEqual((quiet.guarded, quiet.implicit, quiet.unresolved), (0, 0, 0))
        self.assertTrue(self.client.poke('right_hand', (0, 0, 1e7)).success)
        self.client.call_pause(False)
        metrics.first(lambda m: m.guarded > 0 and m.implicit > 0, 'the step guard')

    def test_a_body_at_rest_is_shown_asleep_until_something_disturbs_it(self):
        def asleep(state):
            return state.ragdolls[0].asleep

        def lie_down():
            self.client.restart()
            self.assertFalse(asleep(self.client.step(1)))
            still = self.client.step(1500)
            self.assertTrue(asleep(still))
            after = self.client.step(100)
            self.assertEqual(after.ragdolls[0].positions, still.ragdolls[0].positions)
        lie_down()
        self.settings.update_configuration({'gravity_x': 0.5})
        self.assertFalse(asleep(self.client.step(1)))
        self.settings.update_configuration({'gravity_x': 0.0})
        lie_down()
        self.assertTrue(self.client.poke('right_hand', (0, 0, 50)).success)
        self.assertFalse(asleep(self.client.step(1)))

    def test_joint_angles(self):
        joints = Inbox('/ragdoll/joint_states', JointState)
        first = joints.first(lambda m: True, 'joint states')
        self.assertEqual(len(first.name), len(first.position))
        for name in ('left_knee_y', 'right_elbow_y', 'neck_x', 'left_shoulder_z',
                     'left_shoulder_swing'):
            self.assertIn(name, first.name)
        # At the start the body stands straight, a millimetre of its limits apart.
        knee = first.name.index('left_knee_y')
        self.assertAlmostEqual(first.position[knee], 0, delta=0.02)
        self.client.call_pause(False)
        bent = joints.first(lambda m: abs(m.position[knee]) > 0.3, 'a bent knee')
        self.assertGreater(bent.position[knee], 0)  # and never the wrong way

    def test_joint_angles_of_several_bodies(self):
        self.client.load(path='two')
        joints = Inbox('/ragdoll/joint_states', JointState)
        both = joints.first(lambda m: 'ben/left_knee_y' in m.name, 'the second body')
        first = [n for n in both.name if '/' not in n]
        self.assertEqual(both.name, first + ['ben/' + n for n in first])
        self.assertEqual(len(both.position), len(both.name))

    def markers_of(self, scene, markers, count):
        """Messages of this scene alone, which begins with a DELETEALL, once it is loaded."""
        seen = len(markers.all())
        self.client.load(path=scene)

        def cleared():
            return [i for i, m in enumerate(markers.all()) if i >= seen and
                    m.markers and m.markers[0].action == Marker.DELETEALL]
        first = wait_for(cleared, 'a DELETEALL')[-1] + 1
        wait_for(lambda: len(markers.all()) >= first + count, 'markers of ' + scene)
        return markers.all()[first:]

    def test_markers_are_few_fixed_and_begin_anew_with_a_scene(self):
        markers = Inbox('/ragdoll/markers', MarkerArray)
        self.client.call_pause(False)
        wait_for(lambda: len(markers.all()) > 40, 'markers')
        after = [m for message in self.markers_of('stairs', markers, 40) for m in message.markers]
        self.assertEqual({m.action for m in after}, {Marker.ADD})
        self.assertEqual(len({(m.ns, m.id) for m in after if m.ns == 'obstacles'}), 10)
        self.assertLess(len({(m.ns, m.id) for m in after if m.ns in ('coat', 'sticks')}), 70)
        for m in after:
            # What has no lifetime is told once: what stands, and what TF moves.
            if m.frame_locked:
                self.assertEqual(m.ns, 'coat')
                self.assertTrue(m.header.frame_id.startswith('ragdoll/'))
            else:
                self.assertEqual(m.header.frame_id, 'world')
            self.assertEqual(m.lifetime.to_sec() == 0, m.frame_locked or m.ns == 'obstacles')

    def test_limits_are_drawn_while_asked_for(self):
        markers = Inbox('/ragdoll/markers', MarkerArray)

        def limits(message):
            return {m.id: m for m in message.markers if m.ns == 'limits'}
        wait_for(lambda: len(markers.all()) > 10, 'markers')
        self.assertEqual([limits(m) for m in markers.all() if limits(m)], [])
        self.settings.update_configuration({'show_limits': True})
        shown = limits(markers.first(limits, 'limits'))
        # Of the human's ten joints five are hinges, a fan between two rays, and five are cones, a
        # surface with a rim.
        self.assertEqual(len(shown), 5 * 3 + 5 * 2)
        surfaces = [m for m in shown.values() if m.type == Marker.TRIANGLE_LIST]
        self.assertEqual(len(surfaces), 10)
        for m in surfaces:
            self.assertLess(m.color.a, 1)
        # A fan's triangles share their first corner, the joint.
        model, state = self.client.model, self.client.states.all()[-1]
        corners = [m.points[0] for m in surfaces if m.points[0] == m.points[3]]
        for joint in ('left_knee', 'right_knee', 'left_elbow', 'right_elbow'):
            p = position(model, state, joint)
            self.assertTrue(any(max(abs(c.x - p[0]), abs(c.y - p[1]), abs(c.z - p[2])) < 1e-9
                                for c in corners), joint)
        self.client.load(path='fall')  # another scene does not hide them
        seen = len(markers.all())
        wait_for(lambda: [m for m in markers.all()[seen:] if limits(m)], 'limits')
        self.settings.update_configuration({'show_limits': False})
        wait_for(lambda: not any(limits(m) for m in markers.all()[-10:]), 'the end of limits')

    def test_contacts_are_drawn_while_asked_for(self):
        ball = ('ragdolls: [{model: {particles: {p: {position: [0, 0, 0], mass: 40, radius: 0.1}}},'
                ' position: [0, 0, 0.1]}]\nobstacles: [{type: plane}]\n')
        self.client.load(yaml=ball)
        markers = Inbox('/ragdoll/markers', MarkerArray)
        scenery = Inbox('/ragdoll/scenery', MarkerArray)

        def drawn(message):
            return {m.ns: m for m in message.markers if m.ns in ('contacts', 'forces')}
        self.client.call_pause(False)
        wait_for(lambda: len(markers.all()) > 10, 'markers')
        self.assertEqual([drawn(m) for m in markers.all() if drawn(m)], [])
        self.settings.update_configuration({'show_contacts': True})
        for inbox in (markers, scenery):
            shown = drawn(inbox.first(lambda m: len(drawn(m)) == 2, 'a contact and its force'))
            (point,) = shown['contacts'].points
            self.assertLess(max(abs(point.x), abs(point.y), abs(point.z)), 1e-6)
            tail, tip = shown['forces'].points
            self.assertEqual((tail.x, tail.y, tail.z), (point.x, point.y, point.z))
            self.assertAlmostEqual(tip.z - tail.z, 0.002 * 40 * 9.81, delta=1e-6)
        self.client.load(yaml=ball.replace('40', '20'))  # another scene does not hide them
        markers.first(lambda m: 'forces' in drawn(m) and abs(
            drawn(m)['forces'].points[1].z - 0.002 * 20 * 9.81) < 1e-6, 'the other force')
        self.settings.update_configuration({'show_contacts': False})
        wait_for(lambda: not any(drawn(m) for m in markers.all()[-10:]), 'the end of contacts')

    def test_what_is_held_has_a_ball(self):
        markers = Inbox('/ragdoll/markers', MarkerArray)

        def pins(message):
            return [m for m in message.markers if m.ns == 'pins']
        self.client.load(path='hang')
        (pin,) = pins(markers.first(pins, 'the pin'))
        hand = position(self.client.model, self.client.states.all()[-1], 'right_hand')
        self.assertLess(max(abs(a - b) for a, b in zip(
            hand, (pin.pose.position.x, pin.pose.position.y, pin.pose.position.z))), 1e-9)
        self.assertAlmostEqual(pin.scale.x, 2 * (0.04 + 0.015))  # the hand's radius and a margin
        self.assertEqual([m for m in self.markers_of('fall', markers, 5) if pins(m)], [])

    def test_markers_at_most_thirty_a_second(self):
        markers = Inbox('/ragdoll/markers', MarkerArray)
        self.client.call_pause(False)
        wait_for(markers.all, 'markers')

        def rate():
            begin, seen = rospy.Time.now(), len(markers.all())
            wait_for(lambda: len(markers.all()) >= seen + 60, 'sixty markers')
            return (len(markers.all()) - seen) / (rospy.Time.now() - begin).to_sec()
        # A busy machine delivers in bursts, now and then; it does not do so every time.
        wait_for(lambda: rate() < 31, 'two seconds of thirty a second')

    def test_settings_are_the_scenes(self):
        config = self.settings.get_configuration(timeout=LIMIT)
        self.assertEqual((config['gravity_x'], config['gravity_y'], config['gravity_z']),
                         (0, 0, -9.81))
        self.assertAlmostEqual(config['step'], self.client.step(1).time)

    def test_gravity_changes_while_it_runs(self):
        self.settings.update_configuration({'gravity_z': 0.0, 'gravity_x': 2.0})
        before = self.client.step(1)
        after = self.client.step(1)
        h = after.time - before.time
        mean = [sum(v.x for v in s.ragdolls[0].velocities) / 16 for s in (before, after)]
        self.assertAlmostEqual(mean[1] - mean[0], 2.0 * h, delta=0.5 * h)

    def test_joint_damping_is_the_scenes_and_a_preset_leaves_it(self):
        def told(preset):
            wait_for(lambda: 'preset: ' + preset in self.client.model.scene_yaml, preset)
            return yaml.safe_load(self.client.model.scene_yaml)['solver']['joint_damping']
        self.client.load(yaml='ragdolls: [{model: human}]\nsolver: {joint_damping: 2}')
        wait_for(lambda: self.settings.get_configuration()['joint_damping'] == 2, "the scene's")
        config = self.settings.update_configuration({'preset': 'draft'})
        self.assertEqual((config['joint_damping'], told('draft')), (2, 2))
        config = self.settings.update_configuration({'joint_damping': 3.0, 'preset': 'precise'})
        self.assertEqual((config['joint_damping'], told('precise')), (3, 3))

    def test_the_pace_changes_while_it_runs(self):
        metrics = Inbox('/ragdoll/metrics', Metrics)
        self.client.call_pause(False)
        for factor in (0.5, 3.0):
            config = self.settings.update_configuration({'realtime_factor': factor})
            self.assertEqual(config['realtime_factor'], factor)
            metrics.first(lambda m: abs(m.realtime_factor - factor) < 0.05 * factor,
                          '%g times real time' % factor)
        for wrong in (0.0, -0.5):
            config = self.settings.update_configuration({'realtime_factor': wrong, 'step': 0.001})
            self.assertEqual(config['realtime_factor'], 3.0)
            self.assertNotEqual(config['step'], 0.001)  # nothing is half applied
        self.settings.update_configuration({'realtime_factor': 1.0})

    def test_the_error_class_is_the_presets_as_long_as_its_knobs_are(self):
        metrics = Inbox('/ragdoll/metrics', Metrics)
        self.settings.update_configuration({'preset': 'thesis'})
        metrics.first(lambda m: m.error_class == '20 mm', 'the error class of thesis')
        self.settings.update_configuration({'sweeps': 11})
        metrics.first(lambda m: m.error_class == '', 'no error class')

    def test_a_knob_and_a_preset(self):
        config = self.settings.update_configuration({'step': 0.002})
        self.assertEqual(config['step'], 0.002)
        self.assertAlmostEqual(self.client.step(10).time, 0.02)
        models = Inbox('/ragdoll/model', Model)
        config = self.settings.update_configuration({'preset': 'thesis'})
        self.assertEqual((config['preset'], config['method'], config['sweeps']), ('thesis', 0, 10))
        self.assertAlmostEqual(config['step'], 1 / 60)
        models.first(lambda m: 'thesis' in m.scene_yaml, 'the model with its new settings')
        # The settings stay over a reset and go with another scene.
        self.client.restart()
        self.assertAlmostEqual(self.client.step(1).time, 1 / 60)
        self.client.load(path='fall')
        wait_for(lambda: self.settings.get_configuration()['preset'] != 'thesis',
                 "the scene's settings")


if __name__ == '__main__':
    rospy.init_node('telemetry_test')
    rostest.rosrun('ragdoll_sim', 'telemetry', TelemetryTest, sys.argv)
