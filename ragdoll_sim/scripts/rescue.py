#!/usr/bin/python3
"""A gripper that takes the limp body's hand, drags the body over the floor and up a ramp, and lets go.

Broadcasts the TF frame `gripper`. The force on it is on ~wrenches/attach_<hand> of the node: plot it with
    rqt_plot /ragdoll/wrenches/attach_right_hand/wrench/force/x
Parameters: ~node (/ragdoll), ~hand (right_hand), ~speed (0.4 m/s), ~rounds (0: without end).
"""

import signal
import threading

import rospy
import tf2_ros
from geometry_msgs.msg import TransformStamped, WrenchStamped
from ragdoll_msgs.srv import Attach, Detach
from std_srvs.srv import Trigger

RATE = 100.0                    # [Hz] of the frame
LIFT = 0.5                      # [m] that the hand is held up while it is dragged
WAY = ((2.0, 0.0, 0.0), (5.4, 0.0, 0.65))   # [m] foot of the ramp, and up on it
ENDS = threading.Event()        # rospy's own handler would end ROS within whatever runs


class Gripper:
    def __init__(self):
        self.node = rospy.get_param('~node', '/ragdoll')
        self.hand = rospy.get_param('~hand', 'right_hand')
        self.speed = rospy.get_param('~speed', 0.4)
        self.at = (0.0, 0.0, 1.5)
        self.largest = 0.0
        self.frames = tf2_ros.Buffer()
        tf2_ros.TransformListener(self.frames)
        self.broadcaster = tf2_ros.TransformBroadcaster()
        self.rate = rospy.Rate(RATE)
        self.attach = self.service('attach', Attach)
        self.detach = self.service('detach', Detach)
        self.reset = self.service('reset', Trigger)
        rospy.Subscriber(self.node + '/wrenches/attach_' + self.hand, WrenchStamped, self.feel)

    def service(self, name, kind):
        while not ENDS.is_set():
            try:
                rospy.wait_for_service(self.node + '/' + name, timeout=0.5)
                break
            except rospy.ROSInterruptException:
                raise
            except rospy.ROSException:
                pass  # not yet
        return rospy.ServiceProxy(self.node + '/' + name, kind)

    def feel(self, message):
        f = message.wrench.force
        self.largest = max(self.largest, (f.x ** 2 + f.y ** 2 + f.z ** 2) ** 0.5)

    def tell(self):
        """Broadcasts where the gripper is; lasts 1 / RATE."""
        if ENDS.is_set() or rospy.is_shutdown():
            raise rospy.ROSInterruptException('ROS ends')
        pose = TransformStamped()
        pose.header.stamp = rospy.Time.now()
        pose.header.frame_id, pose.child_frame_id = 'world', 'gripper'
        t = pose.transform.translation
        t.x, t.y, t.z = self.at
        pose.transform.rotation.w = 1
        self.broadcaster.sendTransform(pose)
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
        """Where the hand is [m, world], as TF tells."""
        frame = self.node.strip('/') + '/' + self.hand
        t = self.frames.lookup_transform('world', frame, rospy.Time(0)).transform.translation
        return (t.x, t.y, t.z)

    def round(self):
        self.reset()
        self.at = (0.0, 0.0, 1.5)
        self.wait(1)
        self.move(self.hand_at())
        self.largest = 0.0
        rospy.loginfo('rescue: %s', self.attach(self.hand, 'gripper').status_message)
        self.wait(0.5)
        x, y, z = self.at
        self.move((x, y, z + LIFT))
        for x, y, z in WAY:
            self.move((x, y, z + LIFT))
        self.wait(1)
        rospy.loginfo('rescue: %s; the largest force was %.0f N',
                      self.detach(self.hand).status_message, self.largest)
        self.wait(2)


def main():
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: ENDS.set())
    rospy.init_node('rescue', disable_signals=True)
    gripper = Gripper()
    rounds = rospy.get_param('~rounds', 0)
    done = 0
    while not rospy.is_shutdown() and (rounds == 0 or done < rounds):
        gripper.round()
        done += 1


if __name__ == '__main__':
    try:
        main()
    except (rospy.ROSException, rospy.ServiceException, tf2_ros.TransformException):
        # Of a node that is ending, services and publishers fail where they stand.
        if not (ENDS.is_set() or rospy.is_shutdown()):
            raise
    finally:
        rospy.signal_shutdown('the end')
