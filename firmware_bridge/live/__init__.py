"""The live page: what a browser shows of a bench or a robot while it runs, served on loopback.

The port with its checks is `firmware_bridge.live.socket`, the page one HTML file. What is shown comes as JSON
from who runs the devices or the bridge; requests of the page come back the same way.
"""
