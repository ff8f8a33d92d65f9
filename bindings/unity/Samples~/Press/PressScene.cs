using UnityEngine;

namespace Palpate.Samples
{
    /// <summary>Put this on an empty game object of an empty scene and press Play. It makes an organ ten times its
    /// size, a tool moved by the mouse, a camera and a light. Keys 1 to 4 choose the tissue.</summary>
    public sealed class PressScene : MonoBehaviour
    {
        [Tooltip("Off: a scripted press instead of the mouse.")]
        public bool mouse = true;

        private PalpateOrgan organ;

        private void Start()
        {
            var holder = new GameObject("Palpate");
            holder.SetActive(false); // PalpateOrgan reads its fields when it is enabled
            holder.transform.localScale = 10.0f * Vector3.one;
            organ = holder.AddComponent<PalpateOrgan>();
            if (mouse) organ.devices = new HapticDeviceBehaviour[] { holder.AddComponent<MouseHand>() };
            holder.SetActive(true);
            if (Camera.main == null) MakeCamera();
        }

#if ENABLE_LEGACY_INPUT_MANAGER
        private static readonly string[] Tissues = { "gallbladder", "heart", "liver", "kidney" };

        private void Update()
        {
            for (int i = 0; i < Tissues.Length; ++i)
            {
                if (Input.GetKeyDown(KeyCode.Alpha1 + i)) organ.tissue = Tissues[i];
            }
        }
#endif

        private void OnGUI()
        {
            if (organ == null || organ.Simulation == null || organ.Results.Length == 0) return;
            Result result = organ.Results[0];
            GUILayout.Label(organ.Simulation.Name + (organ.tissue == "" ? "" : ", tissue " + organ.tissue));
            GUILayout.Label(result.TissueForce.ToString("0.00") + " N at " + (1e3 * result.Depth).ToString("0.0") +
                            " mm");
            if (result.Fault != Fault.None) GUILayout.Label(Palpate.Simulation.Describe(result.Fault));
        }

        private static void MakeCamera()
        {
            var eye = new GameObject("Camera") { tag = "MainCamera" };
            eye.AddComponent<Camera>().nearClipPlane = 0.01f;
            eye.transform.position = new Vector3(0.0f, 1.5f, -3.0f);
            eye.transform.LookAt(Vector3.zero);
            var lamp = new GameObject("Light");
            lamp.AddComponent<Light>().type = LightType.Directional;
            lamp.transform.rotation = Quaternion.Euler(50.0f, -30.0f, 0.0f);
        }
    }
}
