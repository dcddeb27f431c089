"""The plant of a closed loop: motor, gear and turntable, with a tendon of either chain."""
