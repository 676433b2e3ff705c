"""The simulators' ends of real autopilots: PX4 and ArduPilot fly the drone's rotors."""
