"""EMG and labels to Lab Streaming Layer, for LabRecorder and any other program on the network.

    python lab_streaming_layer.py MODEL.intent RECORDING

Stream `myointent-emg`: 8 channels, 200 Hz, raw samples. Stream `myointent-labels`: a text when the label changes; its
time is that of the sample after which a board would have emitted it.
"""

import sys
import time

from pylsl import StreamInfo, StreamOutlet, cf_int8, cf_string, local_clock

import myointent

RATE, TOGETHER = 200, 2


def outlets(source):
    """Outlets of EMG and labels; `source` names the armband or the recording."""
    emg = StreamInfo("myointent-emg", "EMG", 8, RATE, cf_int8, f"{source}-emg")
    labels = StreamInfo("myointent-labels", "Markers", 1, 0, cf_string, f"{source}-labels")
    return StreamOutlet(emg), StreamOutlet(labels)


def send(stream, samples, emg, labels, now, last=None):
    """Sends samples, of which the newest is of the time `now`, and the changes of the label; returns the label."""
    emg.push_chunk(samples.tolist(), now)
    for event in stream.push(samples):
        if event.label is not None and event.label != last:
            last = event.label
            labels.push_sample([last], now)
    return last


def main(model, recording):
    recording = myointent.read(recording)[0]
    stream = myointent.Stream(myointent.Model(model))
    emg, labels = outlets(f"{recording.person}/{recording.name}")
    start, last = local_clock(), None
    for at in range(0, len(recording.emg), TOGETHER):
        due = start + at / RATE
        time.sleep(max(0, due - local_clock()))
        last = send(stream, recording.emg[at : at + TOGETHER], emg, labels, due, last)


if __name__ == "__main__":
    main(*sys.argv[1:])
