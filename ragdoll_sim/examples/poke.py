#!/usr/bin/env python3
import rospy
from ragdoll_msgs.msg import State
from ragdoll_msgs.srv import Poke, PokeRequest

rospy.init_node('poke_example')
rospy.wait_for_service('/ragdoll/poke')
poke = rospy.ServiceProxy('/ragdoll/poke', Poke)

request = PokeRequest(body_name='head', duration=rospy.Duration(0.2))
request.force.x = 100  # N; reference_frame is empty: the world's axes
answer = poke(request)
print(answer.status_message)  # which step it begins at, or what was wrong

state = rospy.wait_for_message('/ragdoll/state', State)
for ragdoll in state.ragdolls:
    print(ragdoll.name, 'step', state.step, 'first particle at', ragdoll.positions[0])
