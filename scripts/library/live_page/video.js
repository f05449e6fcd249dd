// Records the animation as a WebM file.
"use strict";

const FRAME_RATE = 30;

function addVideo() {
  const button = $("video");
  button.hidden = sceneParts.length === 0 || !window.MediaRecorder;
  let recorder = null;
  button.addEventListener("click", () => {
    if (recorder) return recorder.stop();
    const parts = [];
    recorder = new MediaRecorder(scene.renderer.domElement.captureStream(FRAME_RATE), { mimeType: "video/webm" });
    recorder.ondataavailable = (event) => parts.push(event.data);
    recorder.onstop = () => {
      save(`${description.name}.webm`, new Blob(parts), "video/webm");
      recorder = null;
      button.textContent = "Video";
    };
    recorder.start();
    button.textContent = "Stop video";
  });
}
