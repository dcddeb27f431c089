"""What a controller acts on: motor, gear and turntable, with a tendon of either chain."""
