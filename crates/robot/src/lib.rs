//! Any URDF as a robot: kinematic tree, limits, forward and inverse kinematics, hands and their preset grasps.
