"""The bridge's side of a device: configure it, command it, receive its reports."""
