"""Position-based ragdolls: scenes stepped from Python, one (World) or many (Crowd).

Lengths in metres, times in seconds, forces in newtons, angles in radians; z is up. Positions are
numpy arrays of shape (n, 3), float64: copies, which later steps do not change.
"""

from ragdoll._ragdoll import Crowd, Error, Fall, World, models, pose_class, scenes

__all__ = ['Crowd', 'Error', 'Fall', 'World', 'models', 'pose_class', 'scenes']
