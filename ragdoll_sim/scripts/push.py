#!/usr/bin/python3
"""A gripper that pushes the ragdoll along the floor and drags it back by its hand, again and again.

Broadcasts the TF frames `gripper` (the scene's paddle follows it) and `gripper/fingers`, which hang
under it. Stands for a robot: to the ragdoll it makes no difference who publishes the frames.
Parameters: ~node (/ragdoll), ~hand (right_hand), ~speed (0.5 m/s), ~rounds (0: without end).
"""

import signal
import threading

import rospy
import tf2_ros
from geometry_msgs.msg import TransformStamped
from ragdoll_msgs.srv import Attach, Detach
from std_srvs.srv import Trigger

RATE = 100.0          # [Hz] of the frames
FINGERS = 0.25        # [m] below the gripper
AT_REST = (-1.0, 0.0, 0.2)
PUSH_TO = (0.6, 0.0, 0.2)
ABOVE = 1.3           # [m] height to travel at
DRAG_TO = (-1.0, 0.5, 1.1)


# rospy's own handler ends ROS within whatever the main thread does, which may hold the lock that
# the end of ROS wants: it would never come.
INTERRUPTED = threading.Event()


def check_end():
    """The end of ROS is the end of the round: neither publishing nor sleeping would tell."""
    if INTERRUPTED.is_set() or rospy.is_shutdown():
        raise rospy.ROSInterruptException('ROS ends')


def wait_for_service(name):
    while True:
        check_end()
        try:
            return rospy.wait_for_service(name, timeout=0.5)
        except rospy.ROSInterruptException:
            raise
        except rospy.ROSException:
            continue  # not yet


class Gripper:
    def __init__(self):
        node = rospy.get_param('~node', '/ragdoll')
        self.hand = rospy.get_param('~hand', 'right_hand')
        self.speed = rospy.get_param('~speed', 0.5)
        self.frame = node.strip('/') + '/' + self.hand
        self.at = AT_REST
        self.frames = tf2_ros.Buffer()
        tf2_ros.TransformListener(self.frames)
        self.broadcaster = tf2_ros.TransformBroadcaster()
        self.rate = rospy.Rate(RATE)
        for name in ('attach', 'detach', 'reset'):
            wait_for_service(node + '/' + name)
        self.call_attach = rospy.ServiceProxy(node + '/attach', Attach)
        self.call_detach = rospy.ServiceProxy(node + '/detach', Detach)
        self.call_reset = rospy.ServiceProxy(node + '/reset', Trigger)

    def tell(self):
        """Broadcasts where the gripper is; lasts 1 / RATE."""
        check_end()
        poses = []
        for parent, child, at in [('world', 'gripper', self.at),
                                  ('gripper', 'gripper/fingers', (0, 0, -FINGERS))]:
            pose = TransformStamped()
            pose.header.stamp = rospy.Time.now()
            pose.header.frame_id, pose.child_frame_id = parent, child
            translation = pose.transform.translation
            translation.x, translation.y, translation.z = at
            pose.transform.rotation.w = 1
            poses.append(pose)
        self.broadcaster.sendTransform(poses)
        self.rate.sleep()

    def wait(self, seconds):
        for _ in range(int(seconds * RATE)):
            self.tell()

    def move(self, goal):
        """Straight to the goal at ~speed."""
        start = self.at
        distance = sum((g - s) ** 2 for g, s in zip(goal, start)) ** 0.5
        steps = max(1, int(distance / self.speed * RATE))
        for i in range(1, steps + 1):
            self.at = tuple(s + (g - s) * i / steps for g, s in zip(goal, start))
            self.tell()

    def hand_at(self):
        """Where the ragdoll's hand is [m, world], as TF tells."""
        t = self.frames.lookup_transform('world', self.frame, rospy.Time(0)).transform.translation
        return (t.x, t.y, t.z)

    def grasp(self):
        """Brings the fingers to the hand and holds it."""
        self.move((self.at[0], self.at[1], ABOVE))
        x, y, z = self.hand_at()
        self.move((x, y, ABOVE))
        x, y, z = self.hand_at()
        self.move((x, y, z + FINGERS))
        answer = self.call_attach(self.hand, 'gripper/fingers')
        rospy.loginfo('push: %s', answer.status_message)

    def round(self):
        self.call_reset()
        self.move(AT_REST)
        self.wait(0.5)
        self.move(PUSH_TO)
        self.wait(0.5)
        self.grasp()
        self.move((self.at[0], self.at[1], ABOVE))
        self.move(DRAG_TO)
        self.wait(1)
        rospy.loginfo('push: %s', self.call_detach(self.hand).status_message)
        self.wait(2)
        self.move((self.at[0], self.at[1], ABOVE))
        self.move((AT_REST[0], AT_REST[1], ABOVE))


def main():
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: INTERRUPTED.set())
    rospy.init_node('push', disable_signals=True)
    gripper = Gripper()
    rounds = rospy.get_param('~rounds', 0)
    done = 0
    while not rospy.is_shutdown() and (rounds == 0 or done < rounds):
        gripper.round()
        done += 1


if __name__ == '__main__':
    try:
        main()
    except (rospy.ROSException, rospy.ServiceException):
        # Of a node that is ending, services and publishers fail where they stand.
        if not (INTERRUPTED.is_set() or rospy.is_shutdown()):
            raise
    finally:
        rospy.signal_shutdown('the end')
