"""Streams patches through an ONNX file: MODEL.onnx PATCHES.npy LOGITS.npy; prints the file's properties."""

import json
import sys

import numpy as np
import onnxruntime

model, patches, out = sys.argv[1:]
options = onnxruntime.SessionOptions()
options.intra_op_num_threads = 1
session = onnxruntime.InferenceSession(model, options, providers=["CPUExecutionProvider"])
state = np.zeros(session.get_inputs()[1].shape, np.float32)
logits = []
for patch in np.load(patches):
    rows, state = session.run(["logits", "new_state"], {"patch": patch, "state": state})
    logits.append(rows)
np.save(out, np.stack(logits))
print(json.dumps(session.get_modelmeta().custom_metadata_map))
